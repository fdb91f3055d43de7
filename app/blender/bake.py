# SPDX-License-Identifier: Apache-2.0
"""Bakes the cloths of a Blender scene: by drape, into point caches."""

from __future__ import annotations

import math
import os
import tempfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import fields, modifiers
from .cloth import BakeError, Positions, make, to_blender, to_drape

NAME = modifiers.NAME
CLOSING = 0.5  # m/s, by which gaps that seams begin with are closed: drape sew's


def _vertices(mesh: Any) -> Positions:
    x = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", x)
    return x.reshape(-1, 3).astype(np.float64)


def _placed(x: Positions, matrix: Any) -> Positions:
    pose = np.array(matrix)
    return x @ pose[:3, :3].T + pose[:3, 3]


def _evaluated(thing: Any, graph: Any) -> Any:
    """The object as Blender computes it now, with its modifiers and its motion."""
    shown = thing.evaluated_get(graph)
    if not shown.is_evaluated:
        raise BakeError(
            f"{thing.name}: it is disabled in viewports, so Blender does not compute "
            "it: enable it, or give it no role"
        )
    return shown


class Cloth:
    """A cloth object: what drape makes of it, and where its pins go."""

    def __init__(self, thing: Any) -> None:
        """Takes the object's pins; `sample` then takes its frames."""
        self.thing, self.name = thing, thing.name
        self.poses: list[NDArray[np.float64]] = []  # one a frame
        self.shapes: list[Positions] = []  # likewise, of drape; without pins the first
        self.notes = modifiers.notes(thing)
        self.weights = self._weights()
        self.pins: list[tuple[int, NDArray[np.int32]]] = []  # by their bodies
        self.goal: Positions | None = None  # that they were told last

    def _weights(self) -> NDArray[np.float64] | None:
        """[vertices, 1] weights of its pins; None: it has none."""
        name = self.thing.drape.pins
        if not name:
            return None
        group = self.thing.vertex_groups.get(name)
        if group is None:
            known = ", ".join(each.name for each in self.thing.vertex_groups)
            raise BakeError(
                f"{self.name}: pins: there is no vertex group {name}; it has "
                f"{known or 'none'}"
            )
        weights = np.zeros((len(self.thing.data.vertices), 1))
        for v in self.thing.data.vertices:
            for g in v.groups:
                if g.group == group.index:
                    weights[v.index] = g.weight
        part = int(((weights > 0) & (weights < 1)).sum())
        if part:
            self.notes.append(
                f"{self.name}: pins: {part} vertices of {name} have weights between 0 "
                "and 1; those above 0.5 are held, the others are free"
            )
        return weights

    def sample(self, graph: Any) -> None:
        """Adds the object as it is now, by the modifiers that lead it."""
        shown = _evaluated(self.thing, graph)
        self.poses.append(np.array(shown.matrix_world))
        if self.shapes and self.weights is None:
            return
        mesh = shown.to_mesh()
        try:
            self.shapes.append(to_drape(_placed(_vertices(mesh), shown.matrix_world)))
        finally:
            shown.to_mesh_clear()

    def make(self, folder: Path) -> None:
        """Finds what drape makes of it, with files in a folder of its own."""
        folder.mkdir()
        self.made = make(self.thing, self.shapes[0], folder)

    def keys(self) -> dict[str, Any]:
        """The cloth as a scene of drape has it."""
        settings = self.thing.drape
        material: dict[str, Any] = {"name": settings.fabric}
        if settings.thickness > 0:
            material["thickness"] = settings.thickness
        if settings.friction >= 0:
            material["friction"] = settings.friction
        return {"name": self.name, "material": material, **self.made.keys()}

    def find(self, world: Any, first: int) -> int:
        """Finds its bodies in a world, the first of which is number `first`, and its
        pins in these; returns the number of the body after them."""
        bodies = world.bodies[first : first + self.made.bodies]
        start = bodies[0].vertices.start
        self.at = slice(start, bodies[-1].vertices.stop)
        if self.weights is None:
            return first + len(bodies)
        self.held = self.made.sampled(self.weights)[:, 0] > 0.5  # not NaN
        if not self.held.any():
            raise BakeError(
                f"{self.name}: pins: no particle has a weight above 0.5 of "
                f"{self.thing.drape.pins}; a garment of smaller cells may have one"
            )
        # how much of each vertex is held by the particles that carry it
        part = self.made.carried(np.repeat(self.held[:, None], 3, 1).astype(float))
        free = int(((self.weights > 0.5) & (part[:, :1] < 0.5)).sum())
        if free:
            self.notes.append(
                f"{self.name}: pins: of the vertices of {self.thing.drape.pins} {free} "
                "stay free, as no particle is near; smaller cells have more"
            )
        for k, body in enumerate(bodies):
            here = slice(body.vertices.start - start, body.vertices.stop - start)
            who = np.flatnonzero(self.held[here]).astype(np.int32)
            self.pins.append((first + k, who))
        return first + len(bodies)

    def lead(self, world: Any, time: float) -> None:
        """Tells its pins where they are at a time, in frames, by the next step."""
        if self.weights is None:
            return
        k = math.ceil(time)
        old, new = self.shapes[k - 1], self.shapes[k]
        goal = self.made.sampled(old + (new - old) * (time - k + 1))[self.held]
        if self.goal is not None and np.array_equal(goal, self.goal):
            return
        self.goal, at = goal, 0
        for cloth, who in self.pins:
            world.set_pins(cloth, who, goal[at : at + len(who)])
            at += len(who)

    def local(self, x: Positions, frame: int) -> NDArray[np.float32]:
        """Particles of drape as the vertices of the object's own mesh."""
        mine = to_blender(self.made.carried(np.asarray(x, np.float64)))
        pose = self.poses[frame]
        if not np.array_equal(pose, np.eye(4)):
            mine = _placed(mine, np.linalg.inv(pose))
        return mine.astype(np.float32)


@dataclass
class Body:
    """An obstacle object, evaluated in each frame."""

    thing: Any
    faces: NDArray[np.int32]
    frames: list[Positions]

    def sample(self, graph: Any, frame: int) -> None:
        """Adds the object as it is now, with its modifiers."""
        shown = _evaluated(self.thing, graph)
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


def _sample(
    scene: Any, cloths: list[Cloth], bodies: list[Body], winds: fields.Winds
) -> None:
    """Goes through the frames once, for cloths, bodies and wind."""
    before = scene.frame_current
    with modifiers.leading(cloth.thing for cloth in cloths):
        try:
            for frame in range(scene.frame_start, scene.frame_end + 1):
                scene.frame_set(frame)
                graph = bpy.context.evaluated_depsgraph_get()
                for cloth in cloths:
                    cloth.sample(graph)
                for body in bodies:
                    body.sample(graph, frame)
                winds.sample(graph)
        finally:
            scene.frame_set(before)


def _definition(
    scene: Any, cloths: list[Cloth], bodies: list[Body], winds: fields.Winds
) -> dict[str, Any]:
    """The Blender scene as a scene of drape; garments are behind the other cloths."""
    seconds = scene.render.fps_base / scene.render.fps
    steps = scene.drape.steps or max(1, math.ceil(60 * seconds))
    gravity = np.array(scene.gravity if scene.use_gravity else (0, 0, 0), float)
    kinds: dict[str, list[dict[str, Any]]] = {"cloths": [], "garments": []}
    for cloth in cloths:
        kinds[cloth.made.kind].append(cloth.keys())
    wind = {"wind": {"velocity": winds.velocities[0].tolist()}} if winds.things else {}
    return {
        "name": scene.name,
        "frames": scene.frame_end - scene.frame_start,
        "dt": seconds / steps,
        "steps_per_frame": steps,
        "gravity": to_drape(gravity).tolist(),
        "backend": scene.drape.backend,
        "threads": 0,
        **kinds,
        "obstacles": [body.keys(seconds) for body in bodies],
        **wind,
    }


def prepare(
    scene: Any, folder: Path
) -> tuple[dict[str, Any], list[Cloth], fields.Winds]:
    """Returns the scene of drape, with files in a folder, its cloths in the order of
    their bodies, and its winds."""
    cloths = [Cloth(thing) for thing in role(scene, "CLOTH")]
    if not cloths:
        raise BakeError("no object of the scene is a cloth")
    bodies = [
        Body(thing, np.empty((0, 3), np.int32), []) for thing in role(scene, "BODY")
    ]
    winds = fields.Winds(scene)
    _sample(scene, cloths, bodies, winds)
    for k, cloth in enumerate(cloths):
        cloth.make(folder / str(k))
    cloths.sort(key=lambda each: each.made.kind)
    return _definition(scene, cloths, bodies, winds), cloths, winds


class _Seams:
    """The gaps that seams begin with, which become less by 0.5 m/s until they are
    closed."""

    def __init__(self, world: Any) -> None:
        self.world, self.gaps = world, [world.seam(k)[0] for k in range(world.seams)]
        self.largest = max((np.abs(gap).max() for gap in self.gaps), default=0.0)
        self.left = self.largest

    def close(self) -> None:
        """Tells the seams the gaps that they have after the next step."""
        if not self.left > 0:
            return
        self.left = max(self.left - CLOSING * self.world.dt, 0)
        for k, gap in enumerate(self.gaps):
            self.world.set_seam(k, gap * (self.left / self.largest))


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
    """Lets the object follow its point cache, after the modifiers that lead it."""
    modifier = thing.modifiers.get(NAME) or thing.modifiers.new(NAME, "MESH_CACHE")
    thing.modifiers.move(thing.modifiers.find(NAME), modifiers.leaders(thing))
    modifier.cache_format = "PC2"
    modifier.filepath = str(path)
    modifier.frame_start = start
    if bpy.data.filepath:
        modifier.filepath = bpy.path.relpath(str(path))


@dataclass
class Result:
    """What a bake tells when it is done; notes: what of the scene is not as it may
    seem, one line each."""

    frames: int = 0
    steps: int = 0
    not_clean: int = 0
    notes: list[str] = field(default_factory=list)


class _Cache:
    """A cloth's point cache while it is written. The object shows it; when it is
    done it takes the place of the one before, else that one is shown again."""

    def __init__(self, cloth: Cloth, frames: int, start: int) -> None:
        from drape.export.pc2 import PointCache

        self.thing, self.start = cloth.thing, start
        modifier = self.thing.modifiers.get(NAME)
        self.before = modifier.filepath if modifier else None
        self.part = cache_path(self.thing).with_suffix(f".{os.getpid()}.part")
        self.file = PointCache(self.part, len(cloth.shapes[0]), frames)
        self.done = False

    def add(self, x: NDArray[np.float32]) -> None:
        """Adds a frame, and shows it."""
        self.file.add(x)
        _attach(self.thing, self.part, self.start)

    def end(self, frames: int) -> None:
        """Puts the file in the place of the one before."""
        self.file.close()
        path = cache_path(self.thing)
        os.replace(self.part, path)
        _attach(self.thing, path, self.start)
        self.thing.drape.baked = frames
        self.done = True

    def close(self) -> None:
        """Leaves what was there before, if it did not end."""
        self.file.close()
        self.part.unlink(missing_ok=True)
        modifier = self.thing.modifiers.get(NAME)
        if self.done or not modifier:
            return
        if self.before is None:
            self.thing.modifiers.remove(modifier)
        else:
            modifier.filepath = self.before


def _frames(
    world: Any, cloths: list[Cloth], winds: fields.Winds, result: Result
) -> Iterator[bool]:
    """Makes the steps of all frames; yields whether a frame is there, at the start and
    after each step."""
    import drape

    yield True
    seams, steps = _Seams(world), world.steps_per_frame
    for k in range(world.frames * steps):
        if winds.things and k % steps == 0:
            winds.blow(world, k // steps + 1)
        for cloth in cloths:
            cloth.lead(world, (k + 1) / steps)
        seams.close()
        [report] = world.step()
        result.steps += 1
        result.not_clean += bool(report.outcome & drape.world.NOT_CLEAN)
        yield (k + 1) % steps == 0


def bake(scene: Any) -> Iterator[tuple[Result, int]]:
    """Bakes all cloths of a scene; yields at the start and after each step, with the
    number of frames. The objects show the frames that there are.

    A bake that is closed before its end, or that fails, leaves what was there. Raises
    BakeError, and drape's errors.
    """
    import drape

    with tempfile.TemporaryDirectory(prefix="drape-") as folder:
        definition, cloths, winds = prepare(scene, Path(folder))
        world = drape.World(definition)
    caches: list[_Cache] = []
    try:
        first, frames = 0, world.frames + 1
        for cloth in cloths:
            first = cloth.find(world, first)
        for cloth in cloths:
            caches.append(_Cache(cloth, frames, scene.frame_start))
        result = Result(notes=[*winds.notes, *(n for c in cloths for n in c.notes)])
        if (unit := scene.unit_settings.scale_length) != 1:
            result.notes.append(
                f"the scene's unit scale {unit:g} has no effect: a unit of Blender is "
                "taken for a metre"
            )
        for whole in _frames(world, cloths, winds, result):
            if whole:
                x = world.read()[0]
                for cloth, cache in zip(cloths, caches, strict=True):
                    cache.add(cloth.local(x[cloth.at], result.frames))
                result.frames += 1
            yield result, frames
        for cache in caches:
            cache.end(frames)
    finally:
        for cache in caches:
            cache.close()
        world.close()
