# SPDX-License-Identifier: Apache-2.0
"""Live control from Python; its rules are tested in C."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import drape
from drape._core import ffi, lib
from drape.control import ROW

pytestmark = pytest.mark.skipif(
    not hasattr(lib, "drape_set_gravity"), reason="the library has no live control"
)


def test_the_row_is_the_struct() -> None:
    struct = ffi.typeof("drape_contact")
    assert ROW.itemsize == ffi.sizeof(struct)
    assert ROW.names == tuple(name for name, _ in struct.fields)
    for name, field in struct.fields:
        assert ROW.fields and ROW.fields[name][1] == field.offset


def test_gravity_and_velocities(sheet: dict[str, Any]) -> None:
    world = drape.World(sheet, gravity=[0, 0, 0], precision=64)
    x = world.positions
    assert world.gravity.tolist() == [0, 0, 0]
    world.set_gravity([0, 0, 3])
    assert world.gravity.tolist() == [0, 0, 3]
    world.step()
    assert x[:, 2].max() == pytest.approx(0.4 / 2 + 3 / 60**2, rel=0.2)
    world.set_velocities(np.tile([0.0, 1.0, 0.0], (len(world), 1)))
    assert (world.velocities[:, 1] == 1).all()
    with pytest.raises(drape.SceneError, match=r"gravity: 2"):
        world.set_gravity([1, 2])
    with pytest.raises(drape.SceneError, match="finite"):
        world.set_gravity([np.inf, 0, 0])


def test_positions(tiny: Path) -> None:
    world = drape.World(tiny)
    cloth = world.bodies[0].vertices
    x = world.positions
    lifted = world.read()[0][cloth] + [0, 0.1, 0]
    world.set_positions(lifted)
    assert np.array_equal(x[cloth], lifted.astype(np.float32))
    inside = lifted.copy()
    inside[:, 1] = world.read()[0][world.bodies[1].vertices][:, 1].mean()
    before = world.digest()
    with pytest.raises(drape.SceneError, match=r"positions: .*intersect"):
        world.set_positions(inside)
    assert world.digest() == before
    with pytest.raises(drape.SceneError, match="positions: 81 × 2"):
        world.set_positions(lifted[:, :2])
    with pytest.raises(drape.SceneError, match="positions"):
        world.set_positions(lifted, first=len(world))


def test_positions_of_a_body(sheet: dict[str, Any]) -> None:
    """Positions and velocities are given as set_pins and set_obstacle take theirs."""
    first, second = ({**sheet["cloths"][0], "name": name} for name in "ab")
    second["start"] = {"at": [0, 1, 0]}
    ball = {"shape": "sphere", "radius": 0.1, "at": [0, -1, 0], "name": "ball"}
    world = drape.World({"cloths": [first, second], "obstacles": [ball]})
    a, b, _ = world.bodies
    n = len(world.positions[a.vertices])
    start = world.read()[0]
    for cloth in (b, "b", 1, np.int64(1)):
        world.set_positions(cloth, start[b.vertices] + [0, 0.1, 0])
        world.set_velocities(cloth, np.full((n, 3), 0.5))
        x, v = world.read()
        assert np.array_equal(x[a.vertices], start[a.vertices])
        assert x[b.vertices] == pytest.approx(start[b.vertices] + [0, 0.1, 0])
        assert (v[b.vertices] == 0.5).all() and (v[a.vertices] == 0).all()
        world.set_positions(start[: 2 * n])
    world.set_velocities(b, [[1.0, 2.0, 3.0]], first=2)
    assert world.read()[1][n + 2].tolist() == [1, 2, 3]
    world.set_positions("a", world.positions[a.vertices])
    with pytest.raises(drape.SceneError, match=f"^b: positions: {n - 1} × 3; expected"):
        world.set_positions(b, start[b.vertices][1:])
    with pytest.raises(drape.SceneError, match=r"^b: velocities: 2 rows .* its vert"):
        world.set_velocities("b", np.zeros((2, 3)), first=n - 1)
    with pytest.raises(drape.SceneError, match=r"^'ball': there is no such cloth.*'a'"):
        world.set_positions(world.bodies[2], start[world.bodies[2].vertices])
    with pytest.raises(drape.SceneError, match="expected a number, a name or a Body"):
        world.set_positions(start[a.vertices], 0)


def test_pins_lead_particles(sheet: dict[str, Any]) -> None:
    world = drape.World(sheet, precision=64)
    name = world.bodies[0].name
    world.set_pins(name, [0, 6], world.read()[0][[0, 6]] + [0, 0.01, 0])
    start = world.read()[0]
    world.step()
    assert world.positions[[0, 6], 1] == pytest.approx(start[[0, 6], 1] + 0.01)
    held = world.positions[[0, 6]].copy()
    world.step(3)
    assert np.array_equal(world.positions[[0, 6]], held)
    world.set_pins(0, [])
    world.step(3)
    assert (world.positions[[0, 6], 1] < held[:, 1]).all()
    with pytest.raises(drape.SceneError, match="pins"):
        world.set_pins(world.bodies[0], [99])
    with pytest.raises(drape.SceneError, match="no such cloth"):
        world.set_pins("nothing", [])


def test_material(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["pins"] = [{"edge": "u0"}]
    ends = []
    for stretch in (None, 50):
        world = drape.World(sheet, precision=64, gravity=[9.81, 0, 0])
        if stretch:
            world.set_material(0, {"stretch": stretch, "shear": 10, "limit": 0.3})
        world.step(30)
        ends.append(world.positions[:, 0].max())
    assert ends[1] > ends[0] + 1e-3
    with pytest.raises(drape.SceneError, match='"strech"; did you mean "stretch"'):
        world.set_material(0, {"strech": 1})
    with pytest.raises(drape.SceneError, match='"mass"; did you mean "density"'):
        world.set_material(0, {"mass": 1})
    with pytest.raises(drape.SceneError, match=r"^material\.limit: expected numbers"):
        world.set_material(0, {"limit": "soft"})
    with pytest.raises(drape.SceneError, match=r"stretch: -1: expected"):
        world.set_material(0, {"stretch": -1})


def test_a_fabric_by_name(sheet: dict[str, Any]) -> None:
    """A material that is set is that of a scene which has it from the start."""
    sheet["cloths"][0]["pins"] = [{"edge": "u0"}]
    made = {"name": "denim", "bend": 1e-4}
    named = json.loads(json.dumps(sheet))
    named["cloths"][0]["material"] = made
    measured = {"stretch": {"modulus": 100, "warp": [[0.01, 0.5]]}, "shear": 10}
    ends = []
    for material in (made, drape.Material(**made), "denim", None):
        world = drape.World(sheet, precision=64)
        world.set_material(0, measured)
        if material:
            world.set_material(0, material)
        world.step(5)
        ends.append(world.positions.copy())
    other = drape.World(named, precision=64)
    other.step(5)
    assert np.array_equal(ends[0], other.positions)
    assert np.array_equal(ends[0], ends[1])
    assert not np.array_equal(ends[0], ends[2])
    assert not np.array_equal(ends[0], ends[3])
    with pytest.raises(drape.SceneError, match='"denin"; did you mean "denim"'):
        world.set_material(0, "denin")
    with pytest.raises(drape.SceneError, match=r"^material: expected a fabric's name"):
        world.set_material(0, 5)  # type: ignore[arg-type]


def test_what_was_wrong_is_told(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["holes"] = [{"disc": [0.3, 0.2, 0.05]}]
    world = drape.World(sheet)
    n = len(world)
    before = world.checkpoint()
    with pytest.raises(drape.SceneError, match=r"material\.bend: -1: expected .* 0 to"):
        world.set_material(0, {"bend": -1})
    with pytest.raises(drape.SceneError, match=r"material\.bend: 2; expected one"):
        world.set_material(0, {"bend": [1, 2]})
    with pytest.raises(drape.SceneError, match=rf"{n + 1} rows from vertex 0 on"):
        world.set_positions(np.zeros((n + 1, 3)))
    with pytest.raises(drape.SceneError, match=rf"2 rows from vertex {n - 1} on"):
        world.set_velocities(np.zeros((2, 3)), first=n - 1)
    with pytest.raises(drape.SceneError, match="rows from vertex -1 on"):
        world.set_velocities(np.zeros((2, 3)), first=-1)
    with pytest.raises(drape.SceneError, match=rf"particle {n}: .* to {n - 1}"):
        world.set_pins(0, [0, n])
    with pytest.raises(drape.SceneError, match="particle 3 is there twice"):
        world.set_pins(0, [3, 1, 3])
    with pytest.raises(drape.SceneError, match="in a hole"):
        world.set_pins(0, [17])
    with pytest.raises(drape.SceneError, match="finite"):
        world.set_pins(0, [0], [[np.nan, 0, 0]])
    with pytest.raises(drape.SceneError, match=r"as in set_positions\(cloth, array"):
        world.set_positions(world.bodies[0])
    with pytest.raises(TypeError, match=r"^first: 1\.5: expected a whole number"):
        world.set_positions(np.zeros((2, 3)), first=1.5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^step: '3': expected a whole number"):
        world.step("3")  # type: ignore[arg-type]
    with pytest.raises(drape.SceneError, match="gravity: one number; expected 3"):
        world.set_gravity(9.81)
    assert world.checkpoint() == before


def test_seams_are_drawn_together() -> None:
    pattern = str(ROOT / "app/patterns/tee.json")
    tee = drape.Garment(pattern=pattern, name="tee", cell=0.04, at=[0, 0, 0])
    world = drape.World(drape.Scene(garments=[tee], gravity=[0, 0, 0]))
    assert world.bodies[0].name == "tee.front"
    first = world.seam(0)[0]
    assert first.shape[1] == 3 and np.linalg.norm(first, axis=1).max() > 0.1
    world.set_seam(0, 0.99 * first)
    assert world.step().clean
    gap, pull = world.seam(0)
    # the loop's tolerance is of gravity's push, and the first step finds all pulls
    assert np.abs(gap - 0.99 * first).max() < 0.05 * 0.04
    assert pull.shape == gap.shape and np.linalg.norm(pull, axis=1).max() > 0
    with pytest.raises(drape.SceneError, match="seam 99: there is no such seam, of 10"):
        world.seam(99)
    with pytest.raises(drape.SceneError, match="seam 0: gap: "):
        world.set_seam(0, [[0, 0, 0]])


def test_a_garment_changes() -> None:
    pattern = str(ROOT / "app/patterns/tee.json")
    tee = drape.Garment(pattern=pattern, name="tee", cell=0.04, at=[0, 0, 0])
    world = drape.World(drape.Scene(garments=[tee], gravity=[0, 0, 0]))
    world.set_wind({"velocity": [0, 0, 1]})
    world.set_material("tee.front", "silk")
    world.step(2)
    assert world.velocities[world.bodies[0].vertices, 2].mean() > 0
    before = [world.seam(k)[1] for k in range(world.seams)]
    names = [b.name for b in world.bodies]
    world.remove("tee.left_sleeve")
    gone = names.index("tee.left_sleeve")
    assert [b.name for b in world.bodies] == names[:gone] + names[gone + 1 :]
    assert 0 < world.seams < len(before)
    after = [world.seam(k)[1] for k in range(world.seams)]
    assert all(any(np.array_equal(a, b) for b in before) for a in after)
    sleeve = drape.Panel(pattern=pattern, name="left_sleeve", cell=0.04)
    added = world.add_cloth(drape.Cloth(name="sleeve", panel=sleeve))
    assert added.rest.shape == world.positions[added.vertices, :2].shape
    assert world.step().clean and world.seams == len(after)


def test_measured_tension(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["pins"] = [{"edge": "u0"}]
    table = {"modulus": 100, "warp": [[0.01, 0.5], [0.02, 20]]}
    ends = []
    for live in (False, True, None):
        scene = json.loads(json.dumps(sheet))
        material = {"stretch": table, "shear": 10}
        if live is False:
            scene["cloths"][0]["material"] = material
        world = drape.World(scene, precision=64, gravity=[9.81, 0, 0])
        if live:
            world.set_material(0, material)
        world.step(30)
        ends.append(world.positions[:, 0].max())
    assert ends[0] == ends[1] != ends[2]
    linear = drape.World(sheet, precision=64, gravity=[9.81, 0, 0])
    linear.set_material(0, {"stretch": 100, "shear": 10})
    taken = drape.World(sheet, precision=64, gravity=[9.81, 0, 0])
    taken.set_material(0, material)
    taken.set_material(0, {"stretch": {"warp": np.empty((0, 2))}})
    for each in (linear, taken):
        each.step(3)
    assert np.array_equal(linear.positions, taken.positions)
    with pytest.raises(drape.SceneError, match="wrap"):
        world.set_material(0, {"stretch": {"wrap": [[0.1, 1]]}})
    with pytest.raises(drape.SceneError, match="expected n × 2"):
        world.set_material(0, {"stretch": {"warp": [0.1, 1]}})
    with pytest.raises(drape.SceneError, match="17 points"):
        world.set_material(0, {"stretch": {"weft": [[0.1, 1]] * 17}})
    with pytest.raises(drape.SceneError, match="range"):
        world.set_material(0, {"stretch": {"warp": [[0.2, 1], [0.1, 2]]}})


def test_obstacles_push_and_contacts_tell(tiny: Path) -> None:
    world = drape.World(tiny, precision=64)
    assert len(world.contacts()) == 0
    world.step(5)
    contacts = world.contacts()
    assert len(contacts) > 0 and contacts.dt == pytest.approx(world.dt, rel=1)
    assert np.linalg.norm(contacts.normals, axis=1) == pytest.approx(1)
    assert contacts.weights.sum(axis=1) == pytest.approx(0, abs=1e-9)
    assert set(contacts.bodies.flat) <= {0, 1} and contacts.vertices.max() < len(world)
    assert contacts.body_impulses.shape == (2, 3)
    assert contacts.body_impulses[0, 1] > 0  # the ball holds the cloth up
    ball = world.bodies[1]
    x = world.read()[0][ball.vertices]
    lifted = np.add(x, [0, 0.01, 0])
    world.set_obstacle(ball.name, lifted)
    world.step()
    assert world.positions[ball.vertices] == pytest.approx(lifted)
    world.set_pose(0, [0, 0.02, 0])
    assert world.step(2).clean
    with pytest.raises(drape.SceneError, match="ball: vertices: 61 × 3; expected 62"):
        world.set_obstacle(0, x[1:])
    with pytest.raises(drape.SceneError, match="ball: pose"):
        world.set_pose(ball, [0, 0, 0], [1, 1, 0, 0])
    with pytest.raises(drape.SceneError, match="contacts"):
        drape.World(tiny, integrator="verlet").contacts()


def test_a_log_replays_a_session(tiny: Path) -> None:
    world = drape.World(tiny)
    world.step(2)
    world.start_log()
    world.step(2)
    world.checkpoint()
    world.set_gravity([1, -9, 0])
    world.step(3)
    log = world.end_log()
    end = world.digest()
    world.step()
    other = drape.World(tiny, threads=2)
    x = other.positions
    reports = list(other.replay(log))
    assert [report.step for report in reports] == [3, 4, 5, 6, 7]
    assert other.digest() == end and np.array_equal(x, other.read()[0])
    with pytest.raises(drape.CheckpointError):
        list(drape.World(tiny).replay(log[:-1]))
    with pytest.raises(drape.Error, match="begun"):
        other.end_log()
