# SPDX-License-Identifier: Apache-2.0
"""Reads the meshes of a USD file, with what moves them but for skeletons."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Tf, Usd, UsdGeom

from drape._meshes import are_of
from drape.errors import SceneError
from drape.meshes import Mesh


def _triangles(prim: Any, time: Any) -> NDArray[np.int32]:
    """The faces of a mesh as fans of triangles."""
    counts = np.array(prim.GetFaceVertexCountsAttr().Get(time) or (), np.int64)
    corner = np.array(prim.GetFaceVertexIndicesAttr().Get(time) or (), np.int32)
    fans = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, fans)
    at = np.arange(len(first)) - np.repeat(np.cumsum(fans) - fans, fans)
    tri = np.stack([corner[first], corner[first + at + 1], corner[first + at + 2]], 1)
    left = prim.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded
    return tri[:, ::-1].copy() if left else tri


def _moves(prim: Any) -> bool:
    """Whether a mesh, or what it is in, changes with time."""
    if prim.GetPointsAttr().ValueMightBeTimeVarying():
        return True
    above = prim.GetPrim()
    while above and not above.IsPseudoRoot():
        if UsdGeom.Xformable(above).TransformMightBeTimeVarying():
            return True
        above = above.GetParent()
    return False


def _points(prim: Any, time: Any, scale: float, turn: bool) -> NDArray[np.float64]:
    """The points of a mesh in the world, [n, 3] m, with +y up."""
    matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim.GetPrim()))
    local = np.array(prim.GetPointsAttr().Get(time) or (), np.float64).reshape(-1, 3)
    x: NDArray[np.float64] = local
    if not np.array_equal(matrix, np.eye(4)):
        x = local @ matrix[:3, :3] + matrix[3, :3]
    x = x * scale if scale != 1 else x
    return np.stack([x[:, 0], x[:, 2], -x[:, 1]], 1) if turn else x


def read(file: Path) -> list[Mesh]:
    """Returns the file's meshes in its order."""
    try:
        stage = Usd.Stage.Open(str(file))
    except Tf.ErrorException as error:
        text = str(error).strip().splitlines()[-1].strip()
        raise SceneError(f"{file}: not a file of USD: {text}") from None
    scale = UsdGeom.GetStageMetersPerUnit(stage)
    turn = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    rate, found = stage.GetTimeCodesPerSecond(), []
    start, stop = stage.GetStartTimeCode(), stage.GetEndTimeCode()
    for each in stage.Traverse(Usd.TraverseInstanceProxies()):
        if not each.IsA(UsdGeom.Mesh):
            continue
        prim, about = UsdGeom.Mesh(each), each.GetCustomData().get("drape", {})
        times = [Usd.TimeCode.EarliestTime()]
        if _moves(prim) and stop > start:
            times = [Usd.TimeCode(t) for t in np.arange(start, stop + 1e-9)]
        frames = [_points(prim, time, scale, turn) for time in times]
        if len({len(x) for x in frames}) > 1:
            raise SceneError(f"{file}: {each.GetPath()}: its vertices come and go")
        if not len(frames[0]):
            continue
        tri, size = _triangles(prim, times[0]), about.get("size")
        if not len(tri) or not are_of(tri, len(frames[0])):
            raise SceneError(f"{file}: {each.GetPath()}: expected faces of its points")
        found.append(
            Mesh(
                each.GetDisplayName() or each.GetName(),
                frames[0],
                tri,
                np.stack(frames) if len(frames) > 1 else None,
                1 / rate,
                (float(size[0]), float(size[1])) if size else None,
                about.get("kind"),
            )
        )
    return found
