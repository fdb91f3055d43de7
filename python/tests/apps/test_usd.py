# SPDX-License-Identifier: Apache-2.0
"""A run written as USD reads back bit for bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from needs import need

from drape.export import Run
from drape.export.cli import export

need("pxr")
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdValidation  # noqa: E402


@pytest.mark.parametrize("ending", [".usdc", ".usda", ".usd"])
def test_every_bit_of_every_frame(still: Path, tmp_path: Path, ending: str) -> None:
    run, file = Run(still), tmp_path / f"run{ending}"
    assert export(run, file) == 9
    stage = Usd.Stage.Open(str(file))
    meshes = [UsdGeom.Mesh(p) for p in stage.Traverse() if p.IsA(UsdGeom.Mesh)]
    assert [m.GetPrim().GetDisplayName() for m in meshes] == [
        b.name for b in run.bodies
    ]
    for prim, body in zip(meshes, run.bodies, strict=True):
        indices = np.array(prim.GetFaceVertexIndicesAttr().Get())
        assert np.array_equal(indices.reshape(-1, 3), body.faces)
        times = prim.GetPointsAttr().GetTimeSamples()
        assert times == ([float(k) for k in run.frames()] if body.moving else [])
        for k in run.frames():
            points = np.array(prim.GetPointsAttr().Get(k))
            assert points.tobytes() == run.positions(body, k).tobytes()
        if body.uv is not None:
            st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
            assert np.array(st.Get()).tobytes() == body.uv.tobytes()
            assert st.GetInterpolation() == UsdGeom.Tokens.vertex


def test_units_axis_rate_and_materials(pushed: Path, tmp_path: Path) -> None:
    file = tmp_path / "run.usdc"
    export(Run(pushed), file)
    stage = Usd.Stage.Open(str(file))
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert stage.GetTimeCodesPerSecond() == stage.GetFramesPerSecond() == 24
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 8)
    ball = UsdGeom.Mesh(stage.GetPrimAtPath("/_7_pushed/ball"))
    assert ball.GetPointsAttr().GetTimeSamples() == [0, 2, 4, 6, 8]
    bound = UsdShade.MaterialBindingAPI(ball.GetPrim()).ComputeBoundMaterial()[0]
    assert str(bound.GetPath()) == "/_7_pushed/materials/ball"
    shader = bound.ComputeSurfaceSource()[0]
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"


def test_normals_have_length_one_and_boxes_hold_all(
    pushed: Path, tmp_path: Path
) -> None:
    file = tmp_path / "run.usdc"
    export(Run(pushed), file)
    stage = Usd.Stage.Open(str(file))
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh = UsdGeom.Mesh(prim)
        points = np.array(mesh.GetPointsAttr().Get(4))
        corners = mesh.GetNormalsInterpolation() == UsdGeom.Tokens.faceVarying
        normals = np.array(mesh.GetNormalsAttr().Get(4))
        faces = np.array(mesh.GetFaceVertexIndicesAttr().Get())
        assert len(normals) == (len(faces) if corners else len(points))
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
        assert np.allclose(
            mesh.GetExtentAttr().Get(4), [points.min(0), points.max(0)], atol=0
        )


def test_64_bits_round_to_nearest(wide: Path, tmp_path: Path) -> None:
    run, file = Run(wide), tmp_path / "run.usdc"
    export(run, file)
    layer = Sdf.Layer.FindOrOpen(str(file))
    attribute = layer.GetAttributeAtPath("/two_sheets/sheet__.points")
    points = np.array(layer.QueryTimeSample(attribute.path, 2.0))
    assert np.array_equal(points, run.positions(run.bodies[0], 2).astype(np.float32))


def test_the_validators_of_usd_are_content(still: Path, tmp_path: Path) -> None:
    file = tmp_path / "run.usdc"
    export(Run(still), file)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 20
    context = UsdValidation.ValidationContext(validators)
    assert not [e.GetMessage() for e in context.Validate(Usd.Stage.Open(str(file)))]
