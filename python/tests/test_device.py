# SPDX-License-Identifier: Apache-2.0
"""Worlds on a GPU: the same bits, and arrays that others take without a copy.
Skipped where this build or machine has no device."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SCENES
from needs import need

import drape


def has_device() -> bool:
    if "gpu: not built in" in drape.info():
        return False
    try:
        drape.World(SCENES / "tiny.json", backend="gpu").close()
    except drape.Error:
        return False
    return True


pytestmark = pytest.mark.skipif(not has_device(), reason="there is no device")


@pytest.mark.parametrize("bits", [32, 64])
def test_the_bits_are_the_references(tiny: Path, bits: int) -> None:
    host = drape.World(tiny, precision=bits)
    device = drape.World(tiny, precision=bits, backend="gpu")
    assert device.backend == "gpu"
    for _ in range(12):
        host.step()
        device.step()
        assert host.digest() == device.digest()
    other = drape.World(tiny, precision=bits)
    other.restore(device.checkpoint())
    assert other.digest() == device.digest()


def test_worlds_side_by_side_have_the_same_bits(tiny: Path) -> None:
    winds = [{"velocity": [k, 0, 0], "density": 1.2} for k in range(12)]
    host = [drape.World(tiny, wind=wind) for wind in winds]
    device = [drape.World(tiny, wind=wind, backend="gpu") for wind in winds]
    for _ in range(3):
        drape.step_many(host, 4)
        drape.step_many(device, 4, threads=12)
        assert [w.digest() for w in host] == [w.digest() for w in device]
    assert len({w.digest() for w in host}) == len(winds)


@pytest.mark.parametrize("bits", [32, 64])
def test_others_take_the_arrays(tiny: Path, bits: int) -> None:
    torch = need("torch")
    world = drape.World(tiny, precision=bits, backend="gpu")
    shared: Any = world.positions
    assert isinstance(shared, drape.SharedArray)
    assert shared.__dlpack_device__() == (2, 0)
    assert not hasattr(shared, "__array_interface__")
    for _ in range(4):
        world.step()
        x = torch.from_dlpack(shared)
        exact = torch.from_numpy(world.read()[0]).to(x.dtype)
        assert x.is_cuda and torch.equal(x.cpu(), exact)
        pointer = shared.__cuda_array_interface__["data"][0]
        assert x.data_ptr() == pointer
        # torch knows no read-only array of __cuda_array_interface__: it refuses
        # the interface and takes the array by DLPack alone.
        with pytest.raises(TypeError, match="read only"):
            torch.as_tensor(shared, device="cuda")


def test_cupy_takes_the_arrays(tiny: Path) -> None:
    cupy = need("cupy")
    world = drape.World(tiny, backend="gpu")
    world.step(3)
    for field, exact in zip(
        (world.positions, world.velocities), world.read(), strict=True
    ):
        for taken in (cupy.asarray(field), cupy.from_dlpack(field)):
            assert np.array_equal(taken.get(), exact)
            assert taken.data.ptr == field.__cuda_array_interface__["data"][0]


def test_streams_keep_their_order() -> None:
    torch = need("torch")
    scene = {"cloths": [{"particles": [301, 301], "size": [3, 3]}]}
    world = drape.World(scene, backend="gpu")
    side = torch.cuda.Stream()
    assert world.stream != side.cuda_stream
    copies, states = [], []
    for _ in range(6):
        world.step()
        states.append(world.read()[0])
        with torch.cuda.stream(side):
            x = torch.from_dlpack(world.positions)
            torch.cuda._sleep(20_000_000)  # the copy comes late
            copies.append(x.clone())
        world.wait_for(side.cuda_stream)
    side.synchronize()
    for copy, state in zip(copies, states, strict=True):
        assert np.array_equal(copy.cpu().numpy(), state.astype(np.float32))
    with pytest.raises(BufferError, match="ambiguous"):
        world.positions.__dlpack__(stream=0)
