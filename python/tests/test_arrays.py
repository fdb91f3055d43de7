# SPDX-License-Identifier: Apache-2.0
"""Arrays that are shared without a copy. Here they lie on the host; a device's
are tested where there is one."""

from __future__ import annotations

import gc
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape

# Whether NumPy asks for DLPack 1, which tells that an array is read-only.
NEW = np.lib.NumpyVersion(np.__version__) >= "2.1.0"


class Old:
    """A consumer that knows DLPack before version 1 only."""

    def __init__(self, array: Any) -> None:
        self.array = array

    def __dlpack__(self, **_: Any) -> Any:
        return self.array.__dlpack__()

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()


@pytest.mark.parametrize("bits", [32, 64])
def test_host_arrays(tiny: Path, bits: int) -> None:
    world = drape.World(tiny, precision=bits)
    world.step(3)
    for array, exact in zip(world.share(), world.read(), strict=True):
        assert array.shape == exact.shape and array.dtype.itemsize == bits // 8
        assert not hasattr(array, "__cuda_array_interface__")
        assert array.__dlpack_device__() == (1, 0)
        one = np.asarray(array)
        two = np.from_dlpack(array) if NEW else np.asarray(array)
        for taken in (one, two):
            assert np.array_equal(taken, exact) and taken.dtype == array.dtype
        # no copy: all of them lie where the world has them
        assert one.ctypes.data == two.ctypes.data
        assert not one.flags.writeable


def test_old_consumers_are_told(tiny: Path) -> None:
    """DLPack before version 1 has no read-only arrays: torch 1.13 wrote to them."""
    world = drape.World(tiny)
    array = world.share()[0]
    with pytest.raises(BufferError, match="give it a copy"):
        np.from_dlpack(Old(array))
    with pytest.warns(UserWarning, match="write to a copy"):
        drape.arrays._tell_read_only(drape.arrays.CUDA)


def test_what_cannot_be_shared(tiny: Path) -> None:
    array = drape.World(tiny).share()[0]
    for wrong in ({"stream": 1}, {"copy": True}, {"dl_device": (2, 0)}):
        with pytest.raises(BufferError):
            array.__dlpack__(max_version=(1, 0), **wrong)


@pytest.mark.parametrize("version", [None, (0, 8), (1, 0), (2, 1)])
def test_capsules_release_what_they_hold(
    tiny: Path, version: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("drape.arrays._tell_read_only", lambda _: None)
    array = drape.World(tiny).share()[0]
    count = sys.getrefcount(array)
    capsule = array.__dlpack__(max_version=version)
    new = version is not None and version[0] >= 1
    assert ("dltensor_versioned" in repr(capsule)) == new
    assert sys.getrefcount(array) == count + 1
    del capsule
    gc.collect()
    assert sys.getrefcount(array) == count
    taken = np.from_dlpack(array) if new and NEW else np.from_dlpack(Old(array))
    assert sys.getrefcount(array) == count + 1
    del taken
    assert sys.getrefcount(array) == count


def test_streams_need_cuda(tiny: Path) -> None:
    if "gpu: not built in" not in drape.info():
        pytest.skip("this build has the device's part")
    world = drape.World(tiny)
    assert world.stream == 0
    with pytest.raises(drape.DeviceError, match="without CUDA"):
        world.wait_for(1)
