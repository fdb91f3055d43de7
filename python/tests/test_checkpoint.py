# SPDX-License-Identifier: Apache-2.0
"""Checkpoints: a world goes on with the same bits, and damage is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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


def test_steps_and_time_follow_the_state(tiny: Path) -> None:
    world = drape.World(tiny)
    assert (world.steps, world.time, world.report) == (0, 0.0, None)
    report = world.step(4)[-1]
    now = (world.steps, world.time)
    assert now == (4, report.time) == (4, pytest.approx(4 * world.dt))
    plain = world.checkpoint()
    world.set_gravity([0, -1, 0])  # such a checkpoint has another form
    world.step(3)
    later = world.checkpoint()
    for data, steps in ((plain, 4), (later, 7), (plain, 4)):
        other = drape.World(tiny)
        for each in (world, other):
            each.restore(data)
            assert each.steps == steps and each.report is None
            assert each.time == pytest.approx(steps * world.dt)
        assert f"{steps} steps" in repr(other)
        assert other.step()[0].step == other.steps == steps + 1
        with pytest.raises(drape.Error, match="before the first step"):
            other.record("nowhere")
    with pytest.raises(drape.CheckpointError):
        world.restore(later[:-1])
    assert (world.steps, world.time) == now


def test_steps_and_time_follow_a_replay(tiny: Path) -> None:
    world = drape.World(tiny)
    world.step(3)
    world.start_log()
    log = world.end_log()
    other = drape.World(tiny)
    assert list(other.replay(log)) == []  # a state, and no step
    assert other.steps == 3 and other.time == world.time
    world.start_log()
    world.step(2)
    assert [r.step for r in other.replay(world.end_log())] == [4, 5]
    assert other.steps == 5 and other.time == world.time


def test_a_trace_may_ask_for_steps_and_time(tiny: Path) -> None:
    seen = set()
    world = drape.World(tiny, trace=lambda *_: seen.add((world.steps, world.time)))
    reports = world.step(2)
    assert seen == {(0, 0.0), (1, reports[0].time)}


def test_wind_follows_a_checkpoint(sheet: dict[str, Any]) -> None:
    sheet["wind"] = {"velocity": [0, 0, 2]}
    world, other = drape.World(sheet), drape.World(sheet)
    data = world.checkpoint()
    world.set_wind({"velocity": [0, 0, 50], "drag": 0.5})
    world.restore(data)
    for each in (world, other):
        each.set_wind({"lift": 0})  # all else is as the checkpoint has it
        each.step(3)
    assert world.digest() == other.digest()


def test_wind_follows_a_log(sheet: dict[str, Any]) -> None:
    sheet["wind"] = {"velocity": [0, 0, 2]}
    world, other = drape.World(sheet), drape.World(sheet)
    world.start_log()
    world.set_wind({"velocity": [0, 0, 9]})
    world.step()
    list(other.replay(world.end_log()))
    for each in (world, other):
        each.set_wind({"drag": 0.5})
        each.step(3)
    assert world.digest() == other.digest()


def two(sheet: dict[str, Any]) -> drape.World:
    """A world of two pinned cloths that gravity stretches."""
    first = {**sheet["cloths"][0], "pins": [{"edge": "u0"}]}
    second = {**first, "name": "second", "start": {"at": [0, 0.5, 0]}}
    return drape.World({"cloths": [first, second]}, gravity=[9.81, 0, 0])


def end(world: drape.World, **numbers: float) -> str:
    """Where it is after some steps with these numbers of the last cloth's."""
    world.set_material("second", numbers)
    world.step(3)
    return world.digest()


def test_materials_follow_a_checkpoint(sheet: dict[str, Any]) -> None:
    """What set_material is not given is as the checkpoint has it."""
    world = two(sheet)
    plain = world.checkpoint()
    world.set_pins(0, [0, 1, 2])
    pinned = world.checkpoint()  # changes, and materials as defined
    world.set_material(1, {"bend": 1e-3})
    bent = world.checkpoint()
    world.set_material(1, {"bend": 1e-2, "stretch": {"warp": [[0.01, 5]]}})
    for data in (plain, pinned, bent, plain):
        world.restore(data)
        other = two(sheet)
        if data != plain:
            other.set_pins(0, [0, 1, 2])
        bend = {"bend": 1e-3} if data == bent else {}
        assert end(world, shear=50) == end(other, shear=50, **bend)
    ends = {end(two(sheet), shear=50), end(two(sheet), shear=50, bend=1e-3)}
    assert len(ends) == 2  # the number can be seen


def test_materials_follow_a_log_and_bodies(sheet: dict[str, Any]) -> None:
    world = two(sheet)
    world.start_log()
    world.set_material(1, {"bend": 1e-3})
    world.step()
    world.remove(0)
    world.step()
    log, later = world.end_log(), world.checkpoint()
    other = two(sheet)
    assert len(list(other.replay(log))) == 2
    for each in (world, other):
        each.set_material(0, {"bend": 1e-2})
        each.restore(later)
    assert end(world, shear=50) == end(other, shear=50)
    third = two(sheet)
    list(third.replay(log))
    assert end(third, shear=50) == other.digest()
    fourth = two(sheet)
    list(fourth.replay(log))
    assert end(fourth, shear=50, bend=1e-5) != other.digest()


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
