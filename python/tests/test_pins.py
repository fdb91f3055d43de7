# SPDX-License-Identifier: Apache-2.0
"""Particles by where they are, groups of pins, poses, and forces of contacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape
from drape.pins import matrix, rigid

TURN = np.array([np.cos(0.3), 0, np.sin(0.3), 0])


def test_particles_by_where_they_are(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["holes"] = [{"disc": [0.3, 0.2, 0.05]}]
    world = drape.World(sheet)  # 7 × 5 particles, every 0.1 m
    assert world.select(0, edge="u0").tolist() == [0, 7, 14, 21, 28]
    assert world.select(0, edge="v1").tolist() == list(range(28, 35))
    assert world.select(0, edge="u1", rect=[0, 0, 1, 0.15]).tolist() == [6, 13]
    assert world.select(0, at=[0.21, 0.09]).tolist() == [9]
    assert 17 not in world.select(0, at=[0.3, 0.2])  # it is in the hole
    assert world.select(0, disc=[0.3, 0.2, 0.11]).tolist() == [10, 16, 18, 24]
    assert len(world.select(0)) == 34
    corner = world.positions[0]
    assert world.select(0, near=corner).tolist() == [0]
    assert world.select(0, near=corner, radius=0.11).tolist() == [0, 1, 7]
    box = [corner - 1e-3, np.add(corner, [0.11, 1, 0])]
    assert world.select(0, box=box).tolist() == [0, 1]
    assert len(world.select(0, near=corner, edge="u1")) == 1
    assert world.bodies[0].rest[8] == pytest.approx([0.1, 0.1])
    for keys, words in (
        ({"edge": "w0"}, "edge: 'w0': expected one of u0"),
        ({"radius": 1}, "radius: it is of near"),
        ({"at": [0, 0, 0]}, "at: 3; expected 2 numbers"),
    ):
        with pytest.raises(drape.SceneError, match=words):
            world.select(0, **keys)


def test_groups_are_led_and_let_go_by_themselves(sheet: dict[str, Any]) -> None:
    world = drape.World(sheet, precision=64)
    start = world.read()[0]
    left = world.pin("left", 0, world.select(0, edge="u0"))
    right = world.pin("right", 0, world.select(0, edge="u1"))
    assert list(world.pins) == ["left", "right"] and "5 of cloth 0" in repr(left)
    right.move([0, 0.01, 0])
    world.step()
    right.move([0, 0.01, 0])
    world.step()
    x = world.read()[0]
    assert np.array_equal(x[left.particles], start[left.particles])
    assert x[right.particles] == pytest.approx(start[right.particles] + [0, 0.02, 0])
    left.release()
    world.step(5)
    x = world.read()[0]
    assert (x[left.particles, 1] < start[left.particles, 1]).all()
    assert x[right.particles] == pytest.approx(right.targets)
    with pytest.raises(drape.SceneError, match="'left': the group was let go"):
        left.to(left.targets)
    with pytest.raises(drape.SceneError, match="'right': there is such a group"):
        world.pin("right", 0, [0])
    with pytest.raises(drape.SceneError, match="particle 6 is in the group 'right'"):
        world.pin("more", 0, [5, 6])
    with pytest.raises(drape.SceneError, match="'more': expected particles 0 to 34"):
        world.pin("more", 0, [35])
    with pytest.raises(drape.SceneError, match="'right': targets: 1 × 3; expected 5"):
        right.to([[0, 0, 0]])
    world.set_pins(0, [])
    assert not world.pins


def test_pins_of_the_scene_are_a_group(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["pins"] = [{"edge": "u0"}]
    world = drape.World(sheet, precision=64)
    start = world.read()[0]
    world.pin("corner", 0, [6]).move([0, 0.01, 0])
    world.step(3)
    assert list(world.pins) == ["scene", "corner"]
    held = world.pins["scene"].particles
    assert np.array_equal(world.read()[0][held], start[held])
    sheet["cloths"][0]["pins"] = [{"edge": "u0", "motion": "go"}]
    sheet["motions"] = [{"name": "go", "keys": [{"time": 0}]}]
    led = drape.World(sheet)
    with pytest.raises(drape.SceneError, match="follow a motion of the scene"):
        led.pin("corner", 0, [6])


def test_pins_follow_a_pose(sheet: dict[str, Any]) -> None:
    box = {"name": "jaw", "shape": "box", "extent": [0.1] * 3, "at": [0, 0.3, 0]}
    sheet["obstacles"] = [box]
    world = drape.World(sheet, precision=64)
    pins = world.pin("jaw", 0, world.select(0, edge="u0"), follow="jaw")
    before = world.read()[0]
    world.set_pose("jaw", [0.1, 0, 0.02], TURN, [0, 0.3, 0])
    world.step()
    at, turn = world.pose("jaw")
    x = world.read()[0]
    for rows in (pins.particles, world.bodies[1].vertices):
        assert x[rows] == pytest.approx(before[rows] @ matrix(turn).T + at, abs=1e-12)
    assert turn == pytest.approx(TURN)
    with pytest.raises(drape.SceneError, match="they follow an obstacle"):
        pins.move([0, 1, 0])
    with pytest.raises(drape.SceneError, match="pins 'jaw' follow its pose"):
        world.set_obstacle("jaw", x[world.bodies[1].vertices])
    world.remove("jaw")
    pins.move([0, 0, 0])
    world.step()


def test_poses_are_read_back(tiny: Path) -> None:
    for precision in (32, 64):
        world = drape.World(tiny, precision=precision)
        position, _ = world.pose(0)
        assert position == pytest.approx(0, abs=1e-6)
        world.set_pose(0, [0.01, 0.02, 0], TURN)
        world.step()
        pose = world.pose("ball")
        assert pose.position == pytest.approx([0.01, 0.02, 0], abs=1e-6)
        assert pose.rotation == pytest.approx(TURN, abs=1e-6)
        world.set_pose(0, *pose)
    wide = world.read()[0][world.bodies[1].vertices] * [1.5, 1, 1]
    world.set_obstacle(0, wide)
    world.step()
    with pytest.raises(drape.SceneError, match="ball: pose: its mesh was deformed"):
        world.pose(0)


def test_a_rigid_fit_of_half_a_turn() -> None:
    x = np.random.default_rng(1).normal(size=(9, 3))
    half = np.array([0, 0.6, 0, 0.8])
    pose, left = rigid(x, x @ matrix(half).T + [1, 2, 3])
    assert left < 1e-12 and pose.position == pytest.approx([1, 2, 3])
    assert matrix(pose.rotation) == pytest.approx(matrix(half))


def test_forces_hold_a_cloth_up(tiny: Path) -> None:
    world = drape.World(tiny, precision=64)
    world.step(8)
    contacts = world.contacts()
    assert contacts.body_forces[0] == pytest.approx(-contacts.body_forces[1])
    forces = contacts.forces()
    cloth, ball = world.bodies
    assert forces[cloth.vertices].sum(0) == pytest.approx(contacts.body_forces[0])
    torques = contacts.body_torques(
        world.positions[ball.vertices].mean(0), world.positions
    )
    assert torques.shape == (2, 3) and np.isfinite(torques).all()
    shape = drape.World(tiny).contacts().body_torques([0, 0, 0], world.positions).shape
    assert shape == (2, 3)  # before the first step there are none
