# SPDX-License-Identifier: Apache-2.0
"""Runs that were written as USD and Alembic are read again, and what others wrote."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from needs import need

import drape
from drape.export import Run, export

# A quad and a triangle in centimetres with +z up, below a moving transform.
OTHER = """#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Z"
    startTimeCode = 0
    endTimeCode = 2
    timeCodesPerSecond = 24
)
def Xform "top" {
    double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 2: (0, 0, 100) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Mesh "roof" {
        int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
        point3f[] points = [(0,0,50), (100,0,50), (100,100,50), (0,100,50), (200,0,50)]
    }
}
"""


def test_a_run_is_read_from_usd(pushed: Path, tmp_path: Path) -> None:
    need("pxr")
    run, file = Run(pushed), tmp_path / "run.usdc"
    export(run, file)
    meshes = drape.read_meshes(file)
    assert list(meshes) == ["sheet é", "sheet é 2", "ball", "materials"]
    for mesh, body in zip(meshes.values(), run.bodies, strict=True):
        assert mesh.kind == body.kind and np.array_equal(mesh.triangles, body.faces)
        frames = mesh.vertices[None] if mesh.frames is None else mesh.frames
        for k in run.frames():
            at = k if len(frames) > 1 else 0
            assert np.array_equal(frames[at], run.positions(body, k))
    towel = meshes["sheet é 2"].cloth(material="denim")
    assert towel.particles == [9, 9] and towel.size == [0.4, 0.4]
    with pytest.raises(drape.SceneError, match=r"sheet é: 1.. vertices.*grid"):
        meshes["sheet é"].cloth()  # it has a hole


def test_units_axes_and_transforms_of_usd(tmp_path: Path) -> None:
    need("pxr")
    (tmp_path / "a.usda").write_text(OTHER)
    [roof] = drape.read_meshes(tmp_path / "a.usda").values()
    assert roof.name == "roof" and roof.frame_dt == 1 / 24
    assert roof.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    assert roof.frames is not None and len(roof.frames) == 3
    assert roof.frames[1] == pytest.approx(
        np.array([[0, 1, 0], [1, 1, 0], [1, 1, -1], [0, 1, -1], [2, 1, 0]], float)
    )
    scene = {
        "cloths": [{"start": {"at": [0, 4, 0]}}],
        "obstacles": [{"mesh": "a.usda"}],
    }
    world = drape.World(scene, folder=tmp_path, dt=1 / 24)
    world.step()
    assert world.positions[world.bodies[1].vertices][:, 1] == pytest.approx(1)
    (tmp_path / "b.usda").write_text("none")
    with pytest.raises(drape.SceneError, match=r"b\.usda: not a file of USD"):
        drape.read_meshes(tmp_path / "b.usda")


def test_a_run_is_read_from_alembic(still: Path, tmp_path: Path) -> None:
    need("bpy")
    run, file = Run(still), tmp_path / "run.abc"
    export(run, file)
    meshes = list(drape.read_meshes(file).values())
    assert len(meshes) == 4
    for body in run.bodies:
        want = [run.positions(body, k) for k in run.frames()]
        found = [each for each in meshes if len(each.vertices) == len(want[0])]
        [mesh] = [
            each for each in found if np.allclose(each.vertices, want[0], atol=1e-6)
        ]
        if body.moving:
            assert mesh.frames is not None
            assert np.allclose(mesh.frames[: len(want)], want, atol=1e-6)
        assert len(mesh.triangles) == len(body.faces)
