# SPDX-License-Identifier: Apache-2.0
"""Writes a run as USD: one Mesh prim a body, with exact time samples.

Time code k is frame k of the run, and `timeCodesPerSecond` is its frame rate.
The stage is in metres with +y up, as the run is. USD's points have 32 bits: a
run of 32 bits keeps every bit, and one of 64 bits is rounded to nearest.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdShade, Vt

from drape.export import mesh
from drape.export.run import Body, Run


def _points(array: NDArray[Any]) -> Vt.Vec3fArray:
    flat = np.ascontiguousarray(array.reshape(-1, 3), np.float32)
    return Vt.Vec3fArray.FromNumpy(flat)


def _material(stage: Usd.Stage, path: str, rgb: tuple[float, ...]) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, path + "/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    kind = Sdf.ValueTypeNames
    shader.CreateInput("diffuseColor", kind.Color3f).Set(Gf.Vec3f(*rgb))
    shader.CreateInput("roughness", kind.Float).Set(0.85)
    out = shader.CreateOutput("surface", kind.Token)
    material.CreateSurfaceOutput().ConnectToSource(out)
    return material


def _define(stage: Usd.Stage, path: str, body: Body) -> UsdGeom.Mesh:
    """A mesh with all of the body that does not change with time."""
    prim = UsdGeom.Mesh.Define(stage, path)
    count, faces = len(body.faces), body.faces.ravel()
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(count, 3, np.int32)))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces))
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateDoubleSidedAttr(True)
    prim.GetPrim().SetDisplayName(body.name)
    prim.GetPrim().SetCustomDataByKey("drape:kind", body.kind)
    if body.grid and body.size:
        prim.GetPrim().SetCustomDataByKey("drape:particles", Gf.Vec2i(*body.grid))
        prim.GetPrim().SetCustomDataByKey("drape:size", Gf.Vec2d(*body.size))
    if body.uv is not None:
        UsdGeom.PrimvarsAPI(prim).CreatePrimvar(
            "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex
        ).Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(body.uv)))
    return prim


def _fill(prim: UsdGeom.Mesh, run: Run, body: Body, frames: list[int]) -> None:
    """Sets points, normals and extent: for each frame, or once."""
    sharp = None
    points, normals = prim.CreatePointsAttr(), prim.CreateNormalsAttr()
    extent = prim.CreateExtentAttr()
    cloth = body.kind == "cloth"
    tokens = UsdGeom.Tokens
    prim.SetNormalsInterpolation(tokens.vertex if cloth else tokens.faceVarying)
    for frame in frames if body.moving else frames[:1]:
        time = Usd.TimeCode(frame) if body.moving else Usd.TimeCode.Default()
        x = run.positions(body, frame)
        if cloth:
            normal = mesh.vertex_normals(x, body.faces)
        else:
            if sharp is None:
                sharp = mesh.sharp_corners(x, body.faces)
            normal = mesh.corner_normals(x, body.faces, sharp)
        points.Set(_points(x), time)
        normals.Set(_points(normal), time)
        box = np.stack([x.min(0), x.max(0)])
        extent.Set(_points(box), time)


def write(run: Run, frames: list[int], path: Path) -> None:
    """Writes these frames of the run into a file that does not exist yet."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(run.fps)
    stage.SetFramesPerSecond(run.fps)
    stage.SetStartTimeCode(frames[0])
    stage.SetEndTimeCode(frames[-1])
    stage.GetRootLayer().comment = f"drape {run.report['drape']}: {run.scene}"
    [top] = mesh.identifiers([run.scene])
    root = UsdGeom.Xform.Define(stage, f"/{top}")
    stage.SetDefaultPrim(root.GetPrim())
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    # "materials" is the scope's name, so no body gets it
    names = mesh.identifiers(["materials"] + [b.name for b in run.bodies])[1:]
    UsdGeom.Scope.Define(stage, f"/{top}/materials")
    for number, (name, body) in enumerate(zip(names, run.bodies, strict=True)):
        prim = _define(stage, f"/{top}/{name}", body)
        rgb = mesh.colour(body, number)
        prim.CreateDisplayColorAttr([Gf.Vec3f(*rgb)])
        material = _material(stage, f"/{top}/materials/{name}", rgb)
        UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(material)
        _fill(prim, run, body, frames)
    stage.GetRootLayer().Save()
