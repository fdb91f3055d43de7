# SPDX-License-Identifier: Apache-2.0
"""Many worlds side by side."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import drape
from drape._core import ffi, lib

STEPS = 8
SIZE = ffi.sizeof("drape_step_report")


def scene(k: int) -> dict[str, Any]:
    """A small sheet that falls on a ball, elsewhere for each k."""
    return {
        "cloths": [
            {"particles": [9, 9], "size": [0.4, 0.4], "start": {"at": [0, 0.36, 0]}}
        ],
        "obstacles": [
            {"shape": "sphere", "radius": 0.15, "at": [0.01 * k, 0.2, 0], "detail": 12}
        ],
    }


@pytest.mark.parametrize("threads", [None, 1, 3, 16])
def test_the_bits_are_those_of_one_after_another(threads: int | None) -> None:
    alone = [drape.World(scene(k)) for k in range(6)]
    for world in alone:
        world.step(STEPS)
    worlds = [drape.World(scene(k)) for k in range(6)]
    reports = drape.step_many(iter(worlds), STEPS // 2, threads=threads)
    reports += drape.step_many(worlds, STEPS - STEPS // 2, threads=threads)
    assert [world.digest() for world in worlds] == [world.digest() for world in alone]
    assert len({world.digest() for world in worlds}) == 6
    assert [[r.step for r in each] for each in reports] == [
        *[[1, 2, 3, 4]] * 6,
        *[[5, 6, 7, 8]] * 6,
    ]
    assert all(each.clean for each in reports)


def hanging(**keys: Any) -> dict[str, Any]:
    """A swatch that falls further than a cell in a step, which a step that may not
    be cut gives up."""
    cloth = {
        "particles": [16, 3],
        "size": [0.015, 0.002],
        "bending": "springs",
        "pins": [{"edge": "u0"}],
    }
    return {"cloths": [cloth], "precond": "multigrid", **keys}


def same(a: drape.StepReport, b: drape.StepReport) -> bool:
    """Whether two reports say the same, but for seconds."""
    return replace(a, seconds={}) == replace(b, seconds={})


@pytest.mark.parametrize("n", [1, STEPS])
def test_each_world_has_its_own(n: int) -> None:
    """Each world's reports, clock and arrays are those that it has alone."""
    alone = [drape.World(scene(k), gravity=[0, -9 - k, 0]) for k in range(5)]
    worlds = [drape.World(scene(k), gravity=[0, -9 - k, 0]) for k in range(5)]
    lines: list[str] = []
    worlds[2] = drape.World(scene(2), gravity=[0, -11, 0], log=lines.append)
    arrays = [(world.positions, world.velocities) for world in worlds]
    for _ in range(2):
        made = drape.step_many(worlds, n)
        assert len({each[-1].kinetic for each in made}) == len(worlds)
        for world, other, mine, (x, v) in zip(worlds, alone, made, arrays, strict=True):
            theirs = other.step(n)
            assert len(mine) == n and all(map(same, mine, theirs))
            assert mine == world.reports and mine[-1] is world.report
            assert (world.steps, world.time) == (other.steps, other.time)
            assert (x == other.read()[0]).all() and (v == other.read()[1]).all()


@pytest.mark.parametrize("bad", range(3))
def test_one_that_diverges_stops_no_other(bad: int) -> None:
    worlds = [drape.World(scene(k)) for k in range(3)]
    worlds[bad] = drape.World(hanging(max_slices=1))
    x = worlds[bad].positions
    before = x.copy()
    with pytest.raises(drape.DivergedError, match="step 1"):
        drape.step_many(worlds, STEPS)
    for k, world in enumerate(worlds):
        done = 0 if k == bad else STEPS
        assert world.steps == done == round(world.time / world.dt)
        assert len(world.reports) == (1 if k == bad else STEPS)
        assert world.report is world.reports[-1]
        assert world.reports.clean is (k != bad)
        assert [r.step for r in world.reports if r.step] == [*range(1, done + 1)]
    assert worlds[bad].reports.outcome & drape.Outcome.DIVERGED
    assert (x == before).all()


class Lacking:
    """The library, in which the second world of each call lacks memory."""

    def __getattr__(self, name: str) -> Any:
        return getattr(lib, name)

    def drape_step_many(self, worlds: Any, n: int, steps: int, *rest: Any) -> int:
        assert lib.drape_step_many(worlds, n, steps, *rest) == lib.DRAPE_OK
        _, made, status = rest
        status[1] = lib.DRAPE_ENOMEM
        ffi.memmove(made + steps, ffi.new("drape_step_report[]", steps), steps * SIZE)
        return int(lib.DRAPE_ENOMEM)


def test_one_that_lacks_memory_stops_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drape.many.lib", Lacking())
    worlds = [drape.World(scene(k)) for k in range(3)]
    with pytest.raises(drape.OutOfMemoryError):
        drape.step_many(worlds)
    assert [len(world.reports) for world in worlds] == [1, 0, 1]


def test_worlds_are_stepped_at_the_same_time() -> None:
    both = threading.Barrier(2, timeout=60)  # passes only if two threads come

    def trace(step: int, stage: str, digest: int, seconds: float) -> None:
        if step == 0 and stage == "springs":
            both.wait()

    worlds = [drape.World(scene(k), trace=trace, integrator="euler") for k in (0, 1)]
    drape.step_many(worlds, threads=2)
    assert not both.broken


def test_one_that_fails_stops_no_other(tiny: Path) -> None:
    worlds = [drape.World(scene(k)) for k in range(4)]
    worlds[1].close()
    with pytest.raises(drape.Error, match="closed"):
        drape.step_many(worlds, STEPS, threads=2)
    for k in (0, 2, 3):
        report = worlds[k].report
        assert report is not None and report.step == STEPS


def test_what_is_refused(tiny: Path) -> None:
    world = drape.World(tiny)
    assert drape.step_many([]) == []
    with pytest.raises(ValueError, match="twice"):
        drape.step_many([world, world])
    with pytest.raises(ValueError, match="threads"):
        drape.step_many([world], threads=0)
    with pytest.raises(TypeError, match=r"worlds\[0\]: expected a drape.World, not 1"):
        drape.step_many([1, 2])  # type: ignore[list-item]
    for wrong in (world, 5):
        with pytest.raises(TypeError, match=r"as in step_many\(\[world\], n\)"):
            drape.step_many(wrong)  # type: ignore[arg-type]
    assert world.report is None
