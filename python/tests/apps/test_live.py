# SPDX-License-Identifier: Apache-2.0
"""A scene that is computed while it is shown gives the frames of a run."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import drape
from apps.runs import FRAMES, STILL, moving
from drape.contacts import Contacts
from drape.errors import SceneError
from drape.export import Run
from drape.viewer import live
from drape.viewer.source import on_cloths


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """The file of the scene of `pushed`."""
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(moving()))
    return file


def wait(source: live.Live) -> None:
    """Waits until all frames are there."""
    end = time.monotonic() + 60
    while source.growing():
        assert time.monotonic() < end
        time.sleep(0.01)


def until(good: Callable[[], bool]) -> None:
    """Waits until something is so."""
    end = time.monotonic() + 60
    while not good():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_frames_are_those_of_the_tool(scene: Path, pushed: Path) -> None:
    run, source = Run(pushed), live.Live(scene)
    wait(source)
    assert list(source.frames()) == list(range(FRAMES + 1))
    assert [b.name for b in source.bodies] == [b.name for b in run.bodies]
    for mine, theirs in zip(source.bodies, run.bodies, strict=True):
        assert np.array_equal(mine.faces, theirs.faces)
        assert mine.moving == theirs.moving
        for frame in run.frames():
            x = source.positions(mine, frame)
            assert x.tobytes() == run.positions(theirs, frame).tobytes()
    assert "contacts" in source.words(FRAMES) and source.words(0) == ""


def test_only_the_latest_frames_are_kept(
    scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "MOST", 20000)
    source = live.Live(scene)
    wait(source)
    kept = list(source.frames())
    assert 2 <= len(kept) < FRAMES and kept[-1] == FRAMES
    body = source.bodies[0]
    assert np.array_equal(source.positions(body, 0), source.positions(body, kept[0]))


def test_closing_ends_the_thread(scene: Path) -> None:
    source = live.Live(scene)
    source.close()
    assert not source.growing()


def test_a_fault_of_the_thread_is_told(
    scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise MemoryError("planted")

    monkeypatch.setattr(live.World, "step", fail)
    source = live.Live(scene)
    with pytest.raises(MemoryError, match="planted"):
        wait(source)


def test_a_scene_that_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "bad.json"
    file.write_text('{"cloths": [{"particles": [1, 1]}]}')
    with pytest.raises(SceneError, match="particles"):
        live.Live(file)


def test_places_and_impulses_of_contacts() -> None:
    x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 0.1], [1, 1, 1]], float)
    pairs = Contacts(
        kind=np.array([0, 1], np.int32),
        vertices=np.array([[3, 0, 1, 2], [0, 1, 3, 4]], np.int32),
        bodies=np.array([[0, 1], [1, 0]], np.int32),
        weights=np.array([[1, -0.6, -0.2, -0.2], [0.25, 0.75, -0.5, -0.5]]),
        normals=np.zeros((2, 3)),
        gaps=np.zeros(2),
        impulses=np.array([[0.0, 0, 2], [0, 0, 3]]),
        body_impulses=np.array([[0.0, 0, -1], [0, 0, 1]]),
        count=5,
        dt=1.0,
    )
    assert np.allclose(pairs.places(x), [[0.2, 0.2, 0.1], [0.75, 0, 0]])
    on_cloth = on_cloths(pairs.bodies, pairs.impulses, 1)
    assert np.array_equal(on_cloth, [[0, 0, 2], [0, 0, -3]])
    assert np.allclose(pairs.forces().sum(0), 0)
    torque = pairs.body_torques([0, 0, 0], x)
    assert np.allclose(torque[0], -torque[1])
    assert np.allclose(torque[0], np.cross([0.2, 0.2, 0.1], [0, 0, 2]) - [0, -2.25, 0])


def test_contacts_hold_a_cloth_up(scene: Path) -> None:
    source = live.Live(scene)
    wait(source)
    before, after = source.contacts(0), source.contacts(FRAMES)
    assert before is not None and not len(before.points)
    assert after is not None and len(after.points) > 10
    assert after.forces[:, 1].sum() > 0
    assert np.linalg.norm(after.points - [0, 0.2, 0], axis=1).max() < 0.6


def test_a_body_is_led_and_put_back() -> None:
    ball = {"name": "ball", "shape": "sphere", "radius": 0.1, "at": [0, -0.3, 0]}
    cloth = {"particles": [9, 9], "pins": [{"edge": "v0"}]}
    source = live.Live(drape.World({"cloths": [cloth], "obstacles": [ball]}), True)
    try:
        start = source.world.pose("ball")[0]
        source.grab(1, start.tolist())
        goal = start + np.array([0.3, 0.0, 0.2])
        source.pull(goal.tolist())
        source.want(30)
        until(lambda: source.frames()[-1] == 30)
        assert np.allclose(source.world.pose("ball")[0], goal)
        body = source.bodies[1]
        moved = source.positions(body, 30) - source.positions(body, 0)
        assert body.moving and np.allclose(moved, goal - start, atol=1e-6)
        source.drop()
        source.restart()
        until(lambda: list(source.frames()) == [0])
        assert np.allclose(source.world.pose("ball")[0], start)
    finally:
        source.close()


def test_an_explicit_integrator_has_no_contacts(scene: Path) -> None:
    keys = json.loads(scene.read_text())
    keys.update(integrator="euler", frames=1)
    scene.write_text(json.dumps(keys))
    source = live.Live(scene)
    wait(source)
    assert source.contacts(1) is None


def test_a_live_scene_has_its_own_colours() -> None:
    scene = json.loads(json.dumps(STILL))
    scene["cloths"][1]["look"] = {"colour": [0.1, 0.7, 0.3]}
    scene["obstacles"][0]["look"] = {"colour": [0.2, 0.2, 0.9]}
    source = live.Live(drape.World(scene), paced=True)
    try:
        colours = [body.colour for body in source.bodies]
    finally:
        source.close()
    assert colours == [None, (0.1, 0.7, 0.3), (0.2, 0.2, 0.9), None]
