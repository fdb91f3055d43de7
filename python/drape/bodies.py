# SPDX-License-Identifier: Apache-2.0
"""Bodies of a world: what they are, and how they come and go between two steps
(spec/control/control.md)."""

from __future__ import annotations

import os
import reprlib
import weakref
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import scene as scenes
from ._core import ffi, lib
from ._define import Handle, put_arrays, read_scene, rest_of, tree_of
from ._library import Calls
from ._signals import Held
from .errors import Error, SceneError, check, check_code
from .record import Recorder


@dataclass(frozen=True)
class Body:
    """A cloth or an obstacle of a world.

    Attributes:
        name: as the scene calls it
        kind: "cloth" or "obstacle"
        vertices, triangles: where its rows are in the world's arrays
        particles: of a cloth, (m, n); particle (i, j) is its vertex i + m·j
        size: of a cloth at rest, (width, height), m
    """

    name: str
    kind: str
    vertices: slice
    triangles: slice
    particles: tuple[int, int] | None = None
    size: tuple[float, float] | None = None

    _panel: NDArray[np.float64] | None = field(default=None, repr=False, compare=False)

    @property
    def rest(self) -> NDArray[np.float64]:
        """[m·n, 2] m, where each particle of a cloth is on the sheet at rest, from
        its corner u0 v0. Those at a panel's outline are not where the grid has them."""
        if self.particles is None or self.size is None:
            raise SceneError(f"{self.name}: an obstacle has no sheet at rest")
        if self._panel is not None:
            return self._panel
        (m, n), (width, height) = self.particles, self.size
        u, v = np.linspace(0, width, m), np.linspace(0, height, n)
        return np.stack([np.tile(u, n), np.repeat(v, m)], axis=1)


def means(body: object, number: int, each: Any) -> bool:
    """Whether a body, which may be its number or its name, is this one."""
    if isinstance(body, (int, np.integer)) and not isinstance(body, bool):
        return int(body) == number
    return body is each or (isinstance(body, str) and body == each.name)


class Bodies:
    """What a `World` has of bodies."""

    bodies: tuple[Body, ...]
    _calls: Calls
    _mirrors: dict[str, weakref.ref[NDArray[Any]]]
    _recorder: Recorder | None
    _text: scenes.Text
    _triangles: NDArray[np.int32]

    def _open(self) -> Handle:
        raise NotImplementedError

    def body(self, name: str) -> Body:
        """Returns the first body of this name; a KeyError if there is none."""
        for body in self.bodies:
            if body.name == name:
                return body
        raise KeyError(f"{name}: no body has this name")

    def add_cloth(self, cloth: scenes.Cloth | Mapping[str, Any]) -> Body:
        """Adds a cloth behind the others, at the world's present time, as the
        scene's reader takes it. Bodies behind it, and their vertices and
        triangles, move up; all keep their state. Arrays that were taken before,
        `Body` objects and contacts are those of the world as it was. Pins may
        name motions of the scene, which hold as if the cloth had been there from
        time 0.

        Returns:
            the new body

        Raises:
            SceneError: it is refused, as where it intersects itself or another
                body; the world is as it was
        """
        return self._add("cloths", {"cloths": [scenes.as_dict(cloth)]})

    def add_obstacle(self, obstacle: scenes.Obstacle | Mapping[str, Any]) -> Body:
        """Adds an obstacle behind all other bodies, likewise. One that follows a
        motion of the scene, or has frames, is where these have it now."""
        cloth = {"particles": [2, 2], **self._largest()}  # a scene must have one
        tree = {"cloths": [cloth], "obstacles": [scenes.as_dict(obstacle)]}
        return self._add("obstacles", tree)

    def _largest(self) -> dict[str, Any]:
        """Returns what of the world's cloths an obstacle is compared with: their
        largest side and their least friction."""
        cloths = [each for each in self.bodies if each.kind == "cloth"]
        side = max(max(each.size or (0, 0)) for each in cloths)
        new, least = ffi.new("drape_material *"), []
        handle = self._open()
        with handle.lock:
            for k in range(len(cloths)):
                check(lib.drape_read_material(handle.world, k, new), "material")
                least.append(new.friction)
        return {"size": [side, side], "material": {"friction": min(least)}}

    def remove(self, body: int | str | Body) -> None:
        """Removes a body; those behind it move down, and keep their state. The
        last cloth stays. Seams go with either of their cloths.

        Args:
            body: its number in `bodies`, its name, or itself
        """
        for k, each in enumerate(self.bodies):
            if means(body, k, each):
                break
        else:
            raise SceneError(f"{reprlib.repr(body)}: there is no such body")
        self._may_change()
        cloths = sum(each.kind == "cloth" for each in self.bodies)
        if each.kind == "cloth" and cloths == 1:
            raise SceneError(f"{each.name}: a world has at least one cloth")
        handle = self._open()
        with Held(), handle.lock:
            check(lib.drape_remove(handle.world, k), "remove")
            lib.core_remove(handle.scene, k)
            if k >= cloths:
                del handle.rest[k - cloths]
            self._forget(each.kind, k if k < cloths else k - cloths)
            self._changed()

    def _forget(self, kind: str, number: int) -> None:
        """Called when a body goes, with its number among those of its kind."""
        raise NotImplementedError

    def _may_change(self) -> None:
        if self._recorder:
            raise Error(
                "the world is being recorded, with the bodies and the time that it has"
            )

    def _add(self, key: str, tree: dict[str, Any]) -> Body:
        """Reads a scene of this one body, and adds it to the world."""
        self._may_change()
        handle = self._open()
        motions = tree_of(self._text).get("motions")
        if motions:
            tree["motions"] = motions
        text = scenes.read(tree, os.path.dirname(self._text.file) or None)
        made = read_scene(text)
        definition = getattr(made, "def")
        kept = put_arrays(definition, text)
        error = ffi.new("drape_error *")
        add = lib.drape_add_cloth if key == "cloths" else lib.drape_add_obstacle
        sort = lib.CORE_CLOTH if key == "cloths" else lib.CORE_OBSTACLE
        new = getattr(definition, key) + (getattr(definition, f"n_{key}") - 1)
        kind = key[:-1]
        with Held(), handle.lock:
            status = add(handle.world, new, error)
            if status >= 0:
                check_code(lib.core_add(handle.scene, sort, new, made))
                if kind == "obstacle":
                    handle.rest.append(rest_of(new))
                self._changed()
            self._calls.raise_kept()
        del kept
        try:
            number = check(status, kind)
        except SceneError as refused:
            words = ffi.string(error.text).decode(errors="replace")
            told = SceneError(f"{kind}: {words}")
            told.status = refused.status
            raise told from None
        return [each for each in self.bodies if each.kind == kind][number]

    def _changed(self) -> None:
        """Takes note of other bodies."""
        self._mirrors.clear()  # what others hold of them stays as it is
        self._triangles = self._read_triangles()
        self.bodies = tuple(self._read_bodies())

    def _read_bodies(self) -> Iterator[Body]:
        handle = self._open()
        definition, scene = handle.definition, handle.scene
        first_v, first_t = lib.drape_first_vertex, lib.drape_first_triangle
        for k in range(definition.n_cloths + definition.n_obstacles):
            vertices = slice(first_v(handle.world, k), first_v(handle.world, k + 1))
            triangles = slice(first_t(handle.world, k), first_t(handle.world, k + 1))
            if k < definition.n_cloths:
                c = definition.cloths[k]
                name = ffi.string(scene.cloth_name[k]).decode(errors="replace")
                grid, size = (c.m, c.n), (c.width, c.height)
                panel = None
                if c.panel:
                    at = ffi.buffer(c.panel.rest, 16 * c.m * c.n)
                    panel = np.frombuffer(at).reshape(-1, 2).copy()
                    panel.flags.writeable = False
                yield Body(name, "cloth", vertices, triangles, grid, size, panel)
            else:
                names = scene.obstacle_name
                name = ffi.string(names[k - definition.n_cloths])
                yield Body(
                    name.decode(errors="replace"), "obstacle", vertices, triangles
                )

    def _read_triangles(self) -> NDArray[np.int32]:
        world = self._open().world
        tri = np.empty((lib.drape_triangles(world), 3), np.int32)
        at = ffi.cast("int32_t (*)[3]", tri.ctypes.data)
        check(lib.drape_read_triangles(world, at), "triangles")
        tri.flags.writeable = False
        return tri
