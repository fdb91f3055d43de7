# SPDX-License-Identifier: Apache-2.0
"""Arrays and meshes of torch, and what torch gets of a world on the host."""

from __future__ import annotations

import inspect
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape

torch = pytest.importorskip("torch", reason="torch is not installed")


def test_tensors_are_taken() -> None:
    scene: dict[str, Any] = {"cloths": [{"particles": [2, 2]}]}
    world = drape.World(scene)
    x = torch.tensor(world.read()[0] + [0, 1, 0], requires_grad=True)
    world.set_positions(0, x)
    scene["cloths"][0]["positions"] = x
    assert np.array_equal(drape.World(scene).positions, world.positions)
    assert drape.Cloth(positions=x) == drape.Cloth(positions=x.detach().numpy())
    mesh = (x, torch.tensor([[0, 1, 2], [1, 3, 2]]))
    assert drape.audit(mesh).count == 0
    obstacle = drape.Obstacle(mesh=(x - torch.tensor([0, 1.0, 0]), mesh[1]))
    both = drape.World(
        drape.Scene(cloths=[drape.Cloth(**scene["cloths"][0])], obstacles=[obstacle])
    )
    assert both.bodies[1].vertices == slice(4, 8)


def test_the_world_cannot_be_written_to(tiny: Path) -> None:
    """torch has no read-only tensors: one of the world's memory would change it."""
    world = drape.World(tiny)
    x, before = world.share()[0], world.digest()
    if "max_version" not in inspect.getsource(torch.from_dlpack):
        with pytest.raises(BufferError, match=r"give it a copy, numpy\.array"):
            torch.from_dlpack(x)
    with warnings.catch_warnings():  # torch's own: it warns once
        warnings.simplefilter("ignore")
        here = torch.from_numpy(np.asarray(x))
    assert here.data_ptr() == x.__array_interface__["data"][0]
    copy = torch.tensor(world.read()[0])
    copy += 1
    assert world.digest() == before
