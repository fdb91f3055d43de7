# SPDX-License-Identifier: Apache-2.0
"""Checkpoints: a world goes on with the same bits, and damage is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drape


def test_a_loaded_world_goes_on(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    world.step(4)
    x = world.positions
    world.save(tmp_path / "a")
    world.step(4)
    end = world.digest()
    other = drape.World(tiny, threads=2)
    other.load(tmp_path / "a")
    other.step(4)
    assert other.digest() == end
    world.load(tmp_path / "a")
    assert np.array_equal(x, world.read()[0]) and world.digest() != end
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_damage_is_refused(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    world.step(4)
    data, before = world.checkpoint(), world.digest()
    flipped = bytes([data[0] ^ 1]) + data[1:]
    for wrong in (b"", data[:-1], data + b"x", flipped):
        fresh = drape.World(tiny)
        state = fresh.digest()
        (tmp_path / "a").write_bytes(wrong)
        with pytest.raises(drape.CheckpointError, match="/a: checkpoint: "):
            fresh.load(tmp_path / "a")
        assert fresh.digest() == state
    with pytest.raises(drape.CheckpointError, match="another scene"):
        drape.World(tiny, precision=64).restore(data)
    assert world.digest() == before
