# SPDX-License-Identifier: Apache-2.0
"""Bodies that come and go, from Python; their rules are tested in C."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape


def high(name: str = "high", **keys: Any) -> drape.Cloth:
    return drape.Cloth(
        name=name,
        particles=[5, 4],
        size=[0.2, 0.15],
        start=drape.Start(at=[0, 2, 0]),
        **keys,
    )


def test_added_and_removed(tiny: Path) -> None:
    world = drape.World(tiny)
    world.step(2)
    world.wake()
    x = world.positions
    before, kept = world.checkpoint(), np.array(x)
    added = world.add_cloth(high(look=drape.Look(gloss=0.5)))
    assert added.name == "high" and added.kind == "cloth"
    assert added.particles == (5, 4) and added.size == (0.2, 0.15)
    assert world.bodies[1] is added and world.body("high") is added
    assert [b.kind for b in world.bodies] == ["cloth", "cloth", "obstacle"]
    assert len(world) == len(kept) + 20 == len(world.positions)
    assert np.array_equal(x, kept)  # what was taken before stays
    assert np.allclose(world.positions[added.vertices][:, 1], 2)
    globe = drape.Obstacle(name="globe", shape="sphere", radius=0.1, at=[0, 5, 0])
    last = world.add_obstacle(globe)
    assert last is world.bodies[3]
    assert len(world.triangles) == last.triangles.stop
    assert world.triangles[last.triangles].min() == last.vertices.start
    world.remove("high")
    world.remove(world.body("globe"))
    assert [b.name for b in world.bodies] == ["cloth", "ball"]
    assert world.checkpoint() == before


def test_a_body_less_is_the_definition_without_it(tmp_path: Path) -> None:
    ball = drape.Obstacle(name="ball", shape="sphere", radius=0.1, at=[0, 1.5, 0])
    both = drape.Scene(cloths=[high("a")], obstacles=[ball])
    world = drape.World(both)
    world.step(3)
    world.remove(1)
    one = drape.World(drape.Scene(cloths=[high("a")]))
    one.restore(world.checkpoint())
    world.step(3)
    one.step(3)
    assert world.digest() == one.digest()
    again = world.add_obstacle(ball)
    assert again.kind == "obstacle"
    assert world.render(tmp_path / "it.png", width=40, height=30).exists()


def test_arrays_motions_and_control() -> None:
    motion = drape.Motion(
        name="up", keys=[drape.Key(time=0), drape.Key(time=1, move=[0, 1, 0])]
    )
    world = drape.World(drape.Scene(cloths=[high("a")], motions=[motion]))
    world.step(30)
    tri, box = [[0, 1, 2]], np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]])
    plate = world.add_obstacle(
        drape.Obstacle(name="plate", vertices=box, triangles=tri, motion="up")
    )
    y = world.positions[plate.vertices][:, 1]
    assert y == pytest.approx(0.5, abs=1e-6)
    world.set_pose("plate", [0, 0.7, 0])
    world.step()
    assert world.positions[plate.vertices][:, 1] == pytest.approx(0.7, abs=1e-6)
    where = np.array([[0, 3, 0], [1, 3, 0], [0, 3, 1], [1, 3, 1.0]])
    flat = drape.Cloth(name="flat", particles=[2, 2], size=[1, 1], positions=where)
    new = world.add_cloth(flat)
    assert np.allclose(world.positions[new.vertices], where)
    world.set_material("flat", {"friction": 0.9})
    world.set_pins("flat", [0, 3])
    world.step()
    assert np.array_equal(world.positions[new.vertices][[0, 3]], where[[0, 3]])


def test_refusals(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    before = world.checkpoint(), world.bodies
    middle = np.array(world.positions[world.bodies[0].vertices]).mean(0)
    across = [[-1, -1, -1], [1, 1, -1], [-1, -1, 1], [1, 1, 1]]
    with pytest.raises(drape.SceneError, match=r"cloth: .*intersecting: cloth"):
        world.add_cloth(
            drape.Cloth(particles=[2, 2], size=[2.8, 2], positions=middle + across)
        )
    with pytest.raises(drape.SceneError, match="particles"):
        world.add_cloth({"particles": [1, 2]})
    with pytest.raises(drape.SceneError, match="colour_of"):
        world.add_obstacle({"shape": "sphere", "colour_of": 1})
    with pytest.raises(drape.SceneError, match="motion"):
        world.add_obstacle({"shape": "sphere", "motion": "none"})
    with pytest.raises(drape.SceneError, match="at least one cloth"):
        world.remove(0)
    with pytest.raises(drape.SceneError, match="no such body"):
        world.remove("nobody")
    assert (world.checkpoint(), world.bodies) == before
    with world.record(tmp_path / "run"), pytest.raises(drape.Error, match="recorded"):
        world.remove(1)
    with pytest.raises(drape.Error, match="recorded"), world.record(tmp_path / "b"):
        world.add_cloth(high())


def test_a_log_with_bodies(tiny: Path) -> None:
    world = drape.World(tiny)
    world.start_log()
    world.step()
    world.add_cloth(high())
    world.step()
    world.remove(0)
    ball = drape.Obstacle(name="ball", shape="sphere", radius=0.1, at=[0, 5, 0])
    world.add_obstacle(ball)
    world.step(2)
    world.remove(1)
    world.step()
    log = world.end_log()
    other = drape.World(tiny)
    steps = []
    for report in other.replay(log):
        steps.append(report.step)
        assert len(other.positions) == len(other)
        assert other.bodies[-1].vertices.stop == len(other)
    assert steps == [1, 2, 3, 4, 5]
    assert other.digest() == world.digest()
    assert [(b.kind, b.particles) for b in other.bodies] == [
        ("cloth", (5, 4)),
        ("obstacle", None),
    ]
    cut = drape.World(tiny)
    with pytest.raises(drape.CheckpointError):
        list(cut.replay(log[:-100]))
    assert cut.bodies[-1].vertices.stop == len(cut)
