# SPDX-License-Identifier: Apache-2.0
"""Bakes the cloths of a Blender scene: by drape, into point caches.

drape has +y up and Blender +z: drape's (x, y, z) is Blender's (x, -z, y).
"""

from __future__ import annotations

import math
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import grid

Positions = NDArray[np.float64]
NAME = "drape"  # of the modifier


class BakeError(Exception):
    """A scene that cannot be baked; the text names the object."""


def to_drape(x: Positions) -> Positions:
    """Positions in Blender's world as drape's."""
    return np.stack([x[..., 0], x[..., 2], -x[..., 1]], -1)


def to_blender(x: Positions) -> Positions:
    """Positions of drape as those in Blender's world."""
    return np.stack([x[..., 0], -x[..., 2], x[..., 1]], -1)


def _vertices(mesh: Any) -> Positions:
    x = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", x)
    return x.reshape(-1, 3).astype(np.float64)


def _placed(x: Positions, matrix: Any) -> Positions:
    pose = np.array(matrix)
    return x @ pose[:3, :3].T + pose[:3, 3]


@dataclass
class Cloth:
    """A cloth object, and the order of its vertices in drape."""

    thing: Any
    rows: NDArray[np.int64]  # [n, m]
    poses: list[NDArray[np.float64]]  # one a frame
    rest: Positions  # [vertices, 3] of its mesh

    def keys(self) -> dict[str, Any]:
        """The cloth as a scene of drape has it."""
        settings = self.thing.drape
        x = to_drape(_placed(self.rest, self.poses[0]))[self.rows]
        n, m = self.rows.shape
        side = grid.size(x)
        material: dict[str, Any] = {"name": settings.fabric}
        if settings.thickness > 0:
            material["thickness"] = settings.thickness
        if settings.friction >= 0:
            material["friction"] = settings.friction
        return {
            "name": self.thing.name,
            "particles": [m, n],
            "size": side,
            "material": material,
            "positions": x.reshape(-1, 3),
            "pins": self._pins(side),
        }

    def _pins(self, side: tuple[float, float]) -> list[dict[str, Any]]:
        """The particles that are in the vertex group of pins, where they start."""
        group = self.thing.vertex_groups.get(self.thing.drape.pins)
        if group is None:
            return []
        held = {
            v.index
            for v in self.thing.data.vertices
            for g in v.groups
            if g.group == group.index and g.weight > 0.5
        }
        n, m = self.rows.shape
        h, g = side[0] / (m - 1), side[1] / (n - 1)
        return [
            {"at": [i * h, j * g]}
            for j in range(n)
            for i in range(m)
            if int(self.rows[j, i]) in held
        ]

    def local(self, x: Positions, frame: int) -> NDArray[np.float32]:
        """Positions [m·n, 3] of drape as those of the mesh's own vertices."""
        mine = np.empty_like(self.rest)
        mine[self.rows.ravel()] = to_blender(x)
        pose = self.poses[frame]
        if np.array_equal(pose, np.eye(4)):
            return mine.astype(np.float32)
        return _placed(mine, np.linalg.inv(pose)).astype(np.float32)


def _cloth(thing: Any) -> Cloth:
    quads = [tuple(p.vertices) for p in thing.data.polygons]
    try:
        rows = grid.order(quads, len(thing.data.vertices))
    except grid.NoGrid as error:
        raise BakeError(f"{thing.name}: {error}") from None
    return Cloth(thing, rows, [], _vertices(thing.data))


@dataclass
class Body:
    """An obstacle object, evaluated in each frame."""

    thing: Any
    faces: NDArray[np.int32]
    frames: list[Positions]

    def sample(self, graph: Any, frame: int) -> None:
        """Adds the object as it is now, with its modifiers."""
        shown = self.thing.evaluated_get(graph)
        mesh = shown.to_mesh()
        try:
            mesh.calc_loop_triangles()
            faces = np.empty(3 * len(mesh.loop_triangles), np.int32)
            mesh.loop_triangles.foreach_get("vertices", faces)
            x = to_drape(_placed(_vertices(mesh), shown.matrix_world))
        finally:
            shown.to_mesh_clear()
        if not self.frames:
            self.faces = faces.reshape(-1, 3)
        name = self.thing.name
        if not len(faces):
            raise BakeError(f"{name}: a body without faces")
        if self.frames and x.shape != self.frames[0].shape:
            raise BakeError(f"{name}: it has other vertices in frame {frame}")
        self.frames.append(x)

    def keys(self, seconds: float) -> dict[str, Any]:
        """The obstacle as a scene of drape has it."""
        first, friction = self.frames[0], self.thing.drape.friction
        keys = {
            "name": self.thing.name,
            "triangles": self.faces,
            "friction": 0.3 if friction < 0 else friction,
        }
        if all(np.array_equal(first, x) for x in self.frames[1:]):
            return {**keys, "vertices": first}
        return {**keys, "vertex_frames": np.array(self.frames), "frame_dt": seconds}


def role(scene: Any, name: str) -> list[Any]:
    """The scene's mesh objects of a role, in the order of their names."""
    found = [o for o in scene.objects if o.type == "MESH" and o.drape.role == name]
    return sorted(found, key=lambda o: o.name)


def _sample(scene: Any, cloths: list[Cloth], bodies: list[Body]) -> None:
    """Goes through the frames once, for poses and bodies."""
    before = scene.frame_current
    try:
        for frame in range(scene.frame_start, scene.frame_end + 1):
            scene.frame_set(frame)
            graph = bpy.context.evaluated_depsgraph_get()
            for cloth in cloths:
                cloth.poses.append(np.array(cloth.thing.matrix_world))
            for body in bodies:
                body.sample(graph, frame)
    finally:
        scene.frame_set(before)


def _definition(scene: Any, cloths: list[Cloth], bodies: list[Body]) -> dict[str, Any]:
    """The Blender scene as a scene of drape."""
    seconds = scene.render.fps_base / scene.render.fps
    steps = scene.drape.steps or max(1, math.ceil(60 * seconds))
    gravity = np.array(scene.gravity if scene.use_gravity else (0, 0, 0), float)
    return {
        "name": scene.name,
        "frames": scene.frame_end - scene.frame_start,
        "dt": seconds / steps,
        "steps_per_frame": steps,
        "gravity": to_drape(gravity).tolist(),
        "backend": scene.drape.backend,
        "threads": 0,
        "cloths": [cloth.keys() for cloth in cloths],
        "obstacles": [body.keys(seconds) for body in bodies],
    }


def cache_path(thing: Any) -> Path:
    """Where a cloth's point cache is: beside the saved file, else temporary."""
    base = bpy.path.abspath("//") or bpy.app.tempdir
    name = bpy.path.clean_name(thing.name)
    if name != thing.name:  # two names may be one when cleaned
        name += f"_{zlib.crc32(thing.name.encode()):08x}"
    return Path(base) / f"{Path(bpy.data.filepath).stem or 'unsaved'}_{name}.pc2"


def free(thing: Any) -> None:
    """Removes a cloth's modifier and its point cache."""
    modifier = thing.modifiers.get(NAME)
    if modifier:
        Path(bpy.path.abspath(modifier.filepath)).unlink(missing_ok=True)
        thing.modifiers.remove(modifier)


def _attach(thing: Any, path: Path, start: int) -> None:
    """Lets the object follow its point cache, before its other modifiers."""
    modifier = thing.modifiers.get(NAME) or thing.modifiers.new(NAME, "MESH_CACHE")
    thing.modifiers.move(thing.modifiers.find(NAME), 0)
    modifier.cache_format = "PC2"
    modifier.filepath = str(path)
    modifier.frame_start = start
    if bpy.data.filepath:
        modifier.filepath = bpy.path.relpath(str(path))


@dataclass
class Result:
    """What a bake tells when it is done."""

    frames: int = 0
    steps: int = 0
    not_clean: int = 0


def bake(scene: Any) -> Iterator[tuple[Result, int]]:
    """Bakes all cloths of a scene; yields after each frame, with their number.

    The caches appear when all frames are done; a bake that is closed before, or
    that fails, leaves what was there. Raises BakeError, and drape's errors.
    """
    import drape
    from drape.export.pc2 import PointCache

    cloths = [_cloth(thing) for thing in role(scene, "CLOTH")]
    if not cloths:
        raise BakeError("no object of the scene is a cloth")
    bodies = [
        Body(thing, np.empty((0, 3), np.int32), []) for thing in role(scene, "BODY")
    ]
    _sample(scene, cloths, bodies)
    world = drape.World(_definition(scene, cloths, bodies))
    frames = world.frames + 1
    parts = [cache_path(c.thing).with_suffix(f".{os.getpid()}.part") for c in cloths]
    files: list[Any] = []
    result = Result()
    try:
        for cloth, part in zip(cloths, parts, strict=True):
            files.append(PointCache(part, len(cloth.rest), frames))
        for frame in range(frames):
            if frame:
                reports = world.step(world.steps_per_frame)
                result.steps += len(reports)
                result.not_clean += sum(
                    bool(r.outcome & drape.world.NOT_CLEAN) for r in reports
                )
            x = world.read()[0]
            for cloth, file, body in zip(cloths, files, world.bodies, strict=False):
                file.add(cloth.local(x[body.vertices], frame))
            result.frames += 1
            yield result, frames
        for cloth, file, part in zip(cloths, files, parts, strict=True):
            file.close()
            path = cache_path(cloth.thing)
            os.replace(part, path)
            _attach(cloth.thing, path, scene.frame_start)
            cloth.thing.drape.baked = frames
    finally:
        for file in files:
            file.close()
        for part in parts:
            part.unlink(missing_ok=True)
        world.close()
