# SPDX-License-Identifier: Apache-2.0
"""Meshes of files, read as bodies; and states and runs written as files."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

import drape
from drape._endings import TOOLS
from drape.meshes import grid_of


def grid(m: int, n: int, flip: bool = False) -> np.ndarray[Any, Any]:
    """The triangles of a grid of m × n particles."""
    a = np.array([i + m * j for j in range(n - 1) for i in range(m - 1)])
    b, c, d = a + 1, a + m, a + m + 1
    cells = [[a, b, c], [b, d, c]] if flip else [[a, b, d], [a, d, c]]
    return np.concatenate([np.stack(each, 1) for each in cells])


@pytest.mark.parametrize("flip", [False, True])
def test_a_grid_is_found(flip: bool) -> None:
    for m, n in ((2, 2), (5, 3), (3, 5), (4, 4)):
        assert grid_of(grid(m, n, flip), m * n, "sheet") == (m, n)
    with pytest.raises(drape.SceneError, match=r"sheet: 15 vertices, 15 tri.*rows"):
        grid_of(grid(5, 3, flip)[1:], 15, "sheet")


def test_the_endings_are_the_tools(tmp_path: Path) -> None:
    file = tmp_path / "a.none"
    file.touch()
    with pytest.raises(drape.SceneError, match="expected a mesh file") as refused:
        drape.read_meshes(file)
    assert tuple(re.findall(r"\.\w+(?=[, ]|$)", str(refused.value))) == TOOLS


def test_a_state_is_written_and_read_again(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    world.step(5)
    x = world.positions
    file = world.export(tmp_path / "a.npz")
    with np.load(file, allow_pickle=False) as data:
        assert np.array_equal(data["positions"], x) and data["time"] == world.time
        assert np.array_equal(data["triangles"], world.triangles)
        assert data["rest"].shape == (len(world), 2)
        assert data["body_names"].tolist() == [each.name for each in world.bodies]
    meshes = drape.read_meshes(file)
    cloth, ball = meshes.values()
    assert (cloth.kind, ball.kind) == ("cloth", "obstacle")
    again = drape.World(
        drape.Scene(cloths=[cloth.cloth()], obstacles=[ball.obstacle()])
    )
    assert np.array_equal(again.positions, x)
    assert [(b.particles, b.size) for b in again.bodies] == [
        (b.particles, b.size) for b in world.bodies
    ]
    [whole] = drape.read_meshes(world.export(tmp_path / "a.ply")).values()
    assert np.array_equal(whole.vertices, x) and len(whole.triangles) == len(
        world.triangles
    )
    assert (
        repr(whole)
        == f"<drape.Mesh 'a': {len(x)} vertices, {len(whole.triangles)} triangles>"
    )
    other = {"cloths": [{}], "obstacles": [{"mesh": str(file)}]}
    with pytest.raises(drape.SceneError, match="intersect"):
        drape.World({**other, "cloths": [{"start": {"at": [0, x[:, 1].mean(), 0]}}]})
    for name, words in (
        ("a.txt", r"expected a name that ends in \.npz, \.ply"),
        ("nowhere/a.ply", "there is no folder"),
    ):
        with pytest.raises(drape.Error, match=words):
            world.export(tmp_path / name)


@pytest.mark.parametrize("ending", ["obj", "off", "stl", "vtk", "vtu"])
def test_formats_of_meshio(tiny: Path, tmp_path: Path, ending: str) -> None:
    meshio = need("meshio")
    world = drape.World(tiny)
    found = meshio.read(world.export(tmp_path / f"a.{ending}"))
    corners = found.points[found.cells_dict["triangle"]]
    assert corners == pytest.approx(world.positions[world.triangles], rel=1e-5)
    if ending in ("vtk", "vtu"):
        assert set(found.cell_data["body"][0]) == {0, 1}
        assert np.nanmax(found.point_data["uv"]) == 1


def test_a_run_is_written_as_arrays_and_frames(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    with world.record(tmp_path / "run"):
        world.step(4 * world.steps_per_frame)
    run = drape.export.Run(tmp_path / "run")
    assert drape.export.export(run, tmp_path / "run.npz", every=2) == 3
    cloth, ball = drape.read_meshes(tmp_path / "run.npz").values()
    assert cloth.frames is not None and len(cloth.frames) == 3 and ball.frames is None
    assert cloth.frame_dt == pytest.approx(2 * run.seconds)
    assert np.array_equal(cloth.frames[2], run.positions(run.bodies[0], 4))
    assert drape.export.export(run, tmp_path / "f_%03d.ply") == 5
    [last] = drape.read_meshes(tmp_path / "f_004.ply").values()
    assert np.array_equal(last.vertices[: len(cloth.vertices)], cloth.frames[2])
    for name in ("f.ply", "f_%s.ply", "f_%d_%d.ply"):
        with pytest.raises(drape.export.RunError, match="a place for its number"):
            drape.export.export(run, tmp_path / name)


def test_what_is_no_mesh_is_told(tmp_path: Path) -> None:
    with pytest.raises(drape.SceneError, match="there is no such file"):
        drape.read_meshes(tmp_path / "none.ply")
    for arrays, words in (
        ({"vertices": np.zeros((3, 3))}, "vertices: expected arrays"),
        ({"vertices": np.zeros((3, 2)), "faces": [[0, 1, 2]]}, r"\(3, 2\); expected n"),
        ({"vertices": np.zeros((3, 3)), "faces": [[0, 1, 3]]}, "vertices 0 to 2"),
        ({"vertices": np.zeros((3, 3)), "faces": [[0, 1]]}, "1 × 2; expected n × 3"),
    ):
        np.savez(tmp_path / "a.npz", **arrays)
        with pytest.raises(drape.SceneError, match=words):
            drape.read_meshes(tmp_path / "a.npz")
    (tmp_path / "b.npz").write_text("none")
    with pytest.raises(drape.SceneError, match="not a file of NumPy's arrays"):
        drape.read_meshes(tmp_path / "b.npz")


def test_frames_of_other_tools_move_an_obstacle(tmp_path: Path) -> None:
    floor = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]], float)
    frames = np.stack([floor, np.add(floor, [0, 0.1, 0])])
    faces = [[0, 2, 1], [0, 3, 2]]
    np.savez(tmp_path / "floor.npz", frames=frames, faces=faces, frame_dt=0.1)
    scene = {
        "cloths": [{"start": {"at": [0, 1, 0]}}],
        "obstacles": [{"mesh": "floor.npz"}],
    }
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    world = drape.World(tmp_path / "scene.json", dt=0.05)
    world.step()
    assert world.positions[world.bodies[1].vertices][:, 1] == pytest.approx(0.05)
    mesh = drape.read_meshes(tmp_path / "floor.npz")["floor"]
    made = drape.World(
        drape.Scene(
            cloths=[drape.Cloth(start=drape.Start(at=[0, 1, 0]))],
            obstacles=[drape.Obstacle(mesh=mesh)],
            dt=0.05,
        )
    )
    made.step()
    assert np.array_equal(made.positions, world.positions)
