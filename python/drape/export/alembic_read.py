# SPDX-License-Identifier: Apache-2.0
"""Reads the meshes of an Alembic file by Blender's own reader (`bpy` from PyPI),
which has +z up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from drape.errors import SceneError
from drape.export.alembic import set_rate
from drape.meshes import FPS, Mesh


def _at(thing: Any) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The vertices of an object now, m, with +y up, and its triangles."""
    made = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = made.to_mesh()
    mesh.calc_loop_triangles()
    x = np.empty(3 * len(mesh.vertices), np.float32)
    tri = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", x)
    mesh.loop_triangles.foreach_get("vertices", tri)
    made.to_mesh_clear()
    matrix = np.array(thing.matrix_world)
    y = x.reshape(-1, 3).astype(np.float64)
    if not np.array_equal(matrix, np.eye(4)):
        y = y @ matrix[:3, :3].T + matrix[:3, 3]
    return np.stack([y[:, 0], y[:, 2], -y[:, 1]], 1), tri.reshape(-1, 3)


def read(file: Path) -> list[Mesh]:
    """Returns the file's meshes, with a frame each 1/60 s of its time."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    set_rate(scene, FPS)
    try:
        bpy.ops.wm.alembic_import(filepath=str(file.resolve()), as_background_job=False)
    except RuntimeError as error:
        raise SceneError(f"{file}: not a file of Alembic: {error}") from None
    things = [each for each in scene.objects if each.type == "MESH"]
    frames: dict[str, list[NDArray[np.float64]]] = {each.name: [] for each in things}
    faces = {}
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        for each in things:
            x, tri = _at(each)
            if len(x) != len(frames[each.name][0] if frames[each.name] else x):
                raise SceneError(f"{file}: {each.name}: its vertices come and go")
            frames[each.name].append(x)
            faces[each.name] = tri
    found = []
    for name, kept in frames.items():
        moving = any(not np.array_equal(kept[0], each) for each in kept)
        all_ = np.stack(kept) if moving else None
        found.append(Mesh(name, kept[0], faces[name], all_, 1 / FPS))
    return found
