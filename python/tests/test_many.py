# SPDX-License-Identifier: Apache-2.0
"""Many worlds side by side."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pytest

import drape

STEPS = 8


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
