# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, and other signals whose handlers raise: no step is lost."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape
from drape._core import lib
from drape.export import Run

SCENE: dict[str, Any] = {"cloths": [{"particles": [31, 31]}], "frames": 12}


def interrupt(*_: object) -> None:
    os.kill(os.getpid(), signal.SIGINT)


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """Each test leaves Ctrl-C's handler as it was; it has Python's own, as a shell's
    background jobs are started without one."""
    outer = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, outer)


class Within:
    """A trace that interrupts within a step: at a stage of a step."""

    def __init__(self, step: int) -> None:
        self.step = step

    def __call__(self, step: int, stage: str, digest: int, seconds: float) -> None:
        if step == self.step and stage == "springs":
            interrupt()


def whole(world: drape.World, held: np.ndarray[Any, Any], steps: int) -> None:
    """A world is that of this number of steps, in all that it tells."""
    assert world.steps == world._clock()[0] == steps
    assert world.report is not None and world.report.step == steps
    assert [report.step for report in world.reports] == list(range(1, steps + 1))
    assert np.array_equal(held, world.read()[0].astype(np.float32))
    other = drape.World(SCENE, threads=1)
    other.step(steps)
    assert world.digest() == other.digest()


def test_a_step_is_whole() -> None:
    world = drape.World(SCENE, threads=1, trace=Within(4))
    held = world.positions
    with pytest.raises(KeyboardInterrupt):
        world.step(1000)
    whole(world, held, 5)
    assert [report.step for report in world.step(2)] == [6, 7]


def test_it_is_heard_between_steps() -> None:
    world = drape.World(SCENE, threads=1)
    held = world.positions
    timer = threading.Timer(0.2, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        world.step(100_000)
    timer.join()
    whole(world, held, world.steps)
    assert 0 < world.steps < 100_000


def test_a_recorded_run_goes_on_in_time(tmp_path: Path) -> None:
    world = drape.World(SCENE, threads=1, trace=Within(1))
    with world.record(tmp_path / "run"):
        with pytest.raises(KeyboardInterrupt):
            world.step(100)
        world.step(2)
    report = json.loads((tmp_path / "run/report.json").read_text())
    assert [step["step"] for step in report["steps"]] == [1, 2, 3, 4]
    assert report["end"] == "complete"
    run, other = Run(tmp_path / "run"), drape.World(SCENE, threads=1)
    assert run.frames() == [0, 1, 2, 3, 4]
    for frame in run.frames():
        x = run.positions(run.bodies[0], frame)
        assert np.array_equal(x, other.read()[0].astype(np.float32)), frame
        other.step()


def test_a_run_that_was_interrupted_says_so(tmp_path: Path) -> None:
    world = drape.World(SCENE, threads=1, trace=Within(1))
    with pytest.raises(KeyboardInterrupt), world.record(tmp_path / "run"):
        world.step(100)
    report = json.loads((tmp_path / "run/report.json").read_text())
    assert (report["end"], len(report["steps"])) == ("interrupted", 2)


def test_a_world_that_is_left_ends_its_run(tmp_path: Path) -> None:
    for wrong, end in ((KeyboardInterrupt, "interrupted"), (ValueError, "failed")):
        with pytest.raises(wrong), drape.World(SCENE, threads=1) as world:
            world.record(tmp_path / end)
            world.step()
            raise wrong
        report = json.loads((tmp_path / end / "report.json").read_text())
        assert (report["end"], len(report["steps"])) == (end, 1)


def test_many_hear_it_before_their_end() -> None:
    plain = [drape.World(SCENE, threads=1) for _ in range(2)]
    traced = drape.World(SCENE, threads=1, trace=lambda *_: None)
    worlds = [*plain, traced]
    held = [world.positions for world in worlds]
    timer = threading.Timer(0.3, interrupt)
    began = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        drape.step_many(worlds, 100_000, threads=2)
    assert time.monotonic() - began < 30
    timer.join()
    for world, x in zip(worlds, held, strict=True):
        whole(world, x, world.steps)
        assert 0 < world.steps < 100_000


def test_a_handler_that_raises_nothing_ends_nothing() -> None:
    calls = []
    before = signal.signal(signal.SIGUSR1, lambda *_: calls.append(world.steps))

    def trace(step: int, stage: str, *_: object) -> None:
        if stage == "springs":
            os.kill(os.getpid(), signal.SIGUSR1)

    try:
        world = drape.World(SCENE, threads=1, trace=trace)
        assert len(world.step(3)) == 3
        other = drape.World(SCENE, threads=1)
        os.kill(os.getpid(), signal.SIGUSR1)
        assert len(drape.step_many([other], 3)[0]) == 3
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert calls == [1, 2, 3, 3]  # it saw the world after each step


def test_another_signal_that_raises() -> None:
    def timed_out(*_: object) -> None:
        raise TimeoutError("too long")

    def trace(step: int, stage: str, *_: object) -> None:
        if step == 2 and stage == "springs":
            os.kill(os.getpid(), signal.SIGALRM)

    before = signal.signal(signal.SIGALRM, timed_out)
    try:
        world = drape.World(SCENE, threads=1, trace=trace)
        held = world.positions
        with pytest.raises(TimeoutError, match="too long"):
            world.step(10)
    finally:
        signal.signal(signal.SIGALRM, before)
    whole(world, held, 3)


class Tripping:
    """The library, with Ctrl-C as soon as a call that changes bodies is done."""

    def __getattr__(self, name: str) -> Any:
        found = getattr(lib, name)
        if name not in ("drape_add_cloth", "drape_remove"):
            return found

        def call(*arguments: Any) -> Any:
            status = found(*arguments)
            interrupt()
            return status

        return call


@pytest.mark.parametrize("added", [True, False])
def test_bodies_come_and_go_whole(added: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    world = drape.World(SCENE, threads=1)
    small = {"particles": [3, 3], "name": "b", "start": {"at": [0, 1, 0]}}
    if not added:
        world.add_cloth(small)
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr("drape.bodies.lib", Tripping())
        if added:
            world.add_cloth(small)
        else:
            world.remove("b")
    assert len(world.bodies) == 1 + added
    assert world.bodies[-1].vertices.stop == len(world)
    assert world.step().clean


def test_what_a_trace_raises_loses_no_step() -> None:
    def wrong(step: int, stage: str, *_: object) -> None:
        if step == 2:
            raise RuntimeError("of the caller's")

    world = drape.World(SCENE, threads=1, trace=wrong)
    held = world.positions
    with pytest.raises(RuntimeError, match="of the caller's"):
        world.step(10)
    whole(world, held, 3)


def test_a_frame_that_is_not_written_is_not_skipped(tmp_path: Path) -> None:
    world = drape.World(SCENE, threads=1)
    recorder = world.record(tmp_path / "run")
    world.step()
    frames = tmp_path / "run/frames"
    frames.rename(tmp_path / "away")
    with pytest.raises(drape.Error, match="cloth_0002"):
        world.step()
    (tmp_path / "away").rename(frames)
    assert (world.steps, len(world.reports)) == (2, 1)
    with pytest.raises(drape.Error, match="recorded no further, as step 2 is not"):
        world.step()
    assert world.steps == 2
    with pytest.warns(UserWarning, match=r"no cloth\.pc2"):
        recorder.close()
    report = json.loads((tmp_path / "run/report.json").read_text())
    assert report["end"] == "failed"
    assert world.step()[0].step == 3


def test_a_recorded_world_does_not_go_back(tmp_path: Path) -> None:
    world = drape.World(SCENE, threads=1)
    data = world.checkpoint()
    world.start_log()
    log = world.end_log()
    with world.record(tmp_path / "run"):
        world.step()
        with pytest.raises(drape.Error, match="recorded"):
            world.restore(data)
        with pytest.raises(drape.Error, match="recorded"):
            list(world.replay(log))
    world.restore(data)
    assert world.steps == 0
