# SPDX-License-Identifier: Apache-2.0
"""Writes a run as Alembic, by Blender's own writer (`bpy` from PyPI).

Alembic has no other well-kept writer for Python. Each body becomes an object
with a Mesh Cache modifier over a point cache of 32 bits, which Blender exports
sample by sample. Blender has +z up and Alembic +y; the two turns between them
only swap and negate coordinates, so all bits of a run of 32 bits are kept.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from drape.export import mesh
from drape.export.pc2 import PointCache
from drape.export.run import Body, Run


def _turned(x: NDArray[Any]) -> NDArray[Any]:
    """Positions with +y up as positions with +z up."""
    x = x.astype(np.float32)
    return np.stack([x[:, 0], -x[:, 2], x[:, 1]], 1)


def _material(name: str, rgb: tuple[float, ...]) -> Any:
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*rgb, 1.0)
    return made


def _object(run: Run, body: Body, frames: list[int], cache: Path) -> Any:
    made = bpy.data.meshes.new(body.name)
    x = _turned(run.positions(body, frames[0]))
    made.from_pydata(x, [], body.faces)
    made.shade_smooth()
    if body.uv is not None:
        layer = made.uv_layers.new(name="st")
        layer.uv.foreach_set("vector", body.uv[body.faces.ravel()].ravel())
    thing = bpy.data.objects.new(body.name, made)
    if body.moving:
        with PointCache(cache, len(x), len(frames)) as out:
            for frame in frames:
                out.add(_turned(run.positions(body, frame)))
        modifier = thing.modifiers.new("frames", "MESH_CACHE")
        modifier.cache_format = "PC2"
        modifier.filepath = str(cache)
        modifier.frame_start = 0
    return thing


def set_rate(scene: Any, fps: float) -> None:
    """Sets Blender's frame rate, a whole number over a float."""
    scene.render.fps = max(1, round(fps))
    scene.render.fps_base = scene.render.fps / fps


def write(run: Run, frames: list[int], path: Path) -> None:
    """Writes these frames of the run, evenly spaced, into a file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    apart = frames[1] - frames[0] if len(frames) > 1 else 1
    set_rate(scene, run.fps / apart)
    with tempfile.TemporaryDirectory() as folder:
        for number, body in enumerate(run.bodies):
            thing = _object(run, body, frames, Path(folder) / f"{number}.pc2")
            rgb = mesh.colour(body, number)
            thing.data.materials.append(_material(body.name, rgb))
            scene.collection.objects.link(thing)
        bpy.ops.wm.alembic_export(
            filepath=str(path),
            start=0,
            end=len(frames) - 1,
            flatten=True,
            uvs=True,
            normals=True,
            packuv=False,
            face_sets=True,
            evaluation_mode="RENDER",
            as_background_job=False,
        )
