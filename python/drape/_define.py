# SPDX-License-Identifier: Apache-2.0
"""Makes a world from a scene: the reader's definition, and arrays put into it."""

from __future__ import annotations

import dataclasses
import json
import os
import threading
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import scene as scenes
from ._core import ffi, lib
from ._library import Calls
from .errors import SceneError, check_code, warn

TIMES = 100  # app/scene/obstacle.c
SOME = 256  # vertices by which a body's pose is found


def rest_of(obstacle: Any) -> np.ndarray[Any, Any] | None:
    """Returns some vertices of a drape_obstacle as it is defined, [n, 4]: number, x,
    y, z, m. None: it has frames, and thus no pose."""
    if obstacle.frames:
        return None
    count = int(obstacle.n_vertices)
    who = np.unique(np.linspace(0, count - 1, min(count, SOME)).astype(np.int64))
    x = np.frombuffer(ffi.buffer(obstacle.x, count * 24)).reshape(-1, 3)
    return np.column_stack([who, x[who]])


class Handle:
    """A world of the library with the scene that it was made of. Both are
    released when nothing refers to this any more.

    Attributes:
        rest: of each obstacle, what `rest_of` returns
        lock: is held by whoever calls the library with the world: calls must not
            overlap in time
    """

    def __init__(self, text: scenes.Text, calls: Calls) -> None:
        self.made = ffi.NULL  # what `world` returns
        self.lock = threading.RLock()
        self.calls = calls  # the library calls them as long as the world is
        self.scene = read_scene(text)
        self.definition = getattr(self.scene, "def")
        kept = put_arrays(self.definition, text)
        count = self.definition.n_obstacles
        self.rest = [rest_of(self.definition.obstacles[k]) for k in range(count)]
        if calls.log:
            self.definition.log = lib.core_log
            self.definition.log_user = calls.pointer
        if calls.trace:
            self.definition.trace = lib.core_trace
            self.definition.trace_user = calls.pointer
        made = ffi.new("drape_world **")
        code = lib.core_create(self.scene, made)
        del kept  # the library has copied the arrays
        check_code(code, self.scene.status)
        self.made = made[0]

    @property
    def world(self) -> Any:
        """The drape_world, for a call of the library."""
        self.calls.refuse_inside()
        return self.made

    def __del__(self) -> None:
        lib.drape_destroy(self.made)


def read_scene(text: scenes.Text, notes: bool = True) -> Any:
    """Returns what the tool's reader makes of a scene, a struct scene; without the
    warnings that it notes, if these are not for the caller."""
    data = text.text.encode(errors="surrogateescape")
    out = ffi.new("struct scene **")
    code = lib.core_read(data, len(data), os.fsencode(text.file), out)
    if not notes:
        lib.core_notes()  # which forgets them
    check_code(code)
    return ffi.gc(out[0], lib.core_free)


def put_arrays(definition: Any, text: scenes.Text) -> list[np.ndarray[Any, Any]]:
    """Puts the arrays of a scene's bodies into its definition. Returns them:
    they must live until the world is made."""
    kept: list[np.ndarray[Any, Any]] = []

    def pointer(value: Any, shape: tuple[int | None, ...], where: str) -> Any:
        kept.append(scenes.array(value, shape, where))
        return ffi.cast("double (*)[3]", kept[-1].ctypes.data)

    for k, arrays in enumerate(text.cloths):
        cloth = definition.cloths[k]
        shape = (cloth.m * cloth.n, 3)
        for key, field in (("positions", "x"), ("velocities", "velocity")):
            if key in arrays:
                where = f"cloths[{k}].{key} of {cloth.m} × {cloth.n} particles"
                at = pointer(arrays[key], shape, where)
                setattr(cloth, field, at)
    for k, arrays in enumerate(text.obstacles):
        if arrays:
            where = f"obstacles[{k}]"
            put_mesh(definition.obstacles[k], arrays, where, kept, pointer)
            compare(definition, kept[-1], where)
    return kept


def compare(definition: Any, x: np.ndarray[Any, Any], where: str) -> None:
    """Warns where vertices are so much farther apart, or nearer, than the sides of
    all cloths are long that they probably have another unit than metres."""
    cloths = [definition.cloths[k] for k in range(definition.n_cloths)]
    cloth = max(max(each.width, each.height) for each in cloths)
    x = x.reshape(-1, 3)
    size = float(np.ptp(x, axis=0).max()) if len(x) else 0
    if 0 < size < np.inf and not cloth <= TIMES * size <= TIMES**2 * cloth:
        warn(
            f"{where}: note: the mesh is {size:.3g} m across, the largest cloth "
            f"{cloth:.3g} m; the vertices of a mesh are in metres"
        )


def put_mesh(
    obstacle: Any, arrays: scenes.Arrays, where: str, kept: list[Any], pointer: Any
) -> None:
    """Puts an obstacle's arrays into its definition."""
    if "triangles" not in arrays:
        raise SceneError(f"{where}: its arrays lack triangles")
    if ("vertices" in arrays) == ("vertex_frames" in arrays):
        raise SceneError(f"{where}: expected one of vertices and vertex_frames")
    tri = scenes.array(
        arrays["triangles"], (None, 3), f"{where}.triangles", kind=np.int32
    )
    kept.append(tri)
    obstacle.tri = ffi.cast("int32_t (*)[3]", tri.ctypes.data)
    obstacle.n_triangles = len(tri)
    for key in ("frame_dt", "frame_times", "between"):
        if key in arrays and "vertices" in arrays:
            raise SceneError(f"{where}: {key}: it has no vertex_frames")
    if "vertices" in arrays:
        obstacle.x = pointer(arrays["vertices"], (None, 3), f"{where}.vertices")
        obstacle.n_vertices = len(kept[-1])
        return
    shape = (None, None, 3)
    obstacle.frame = pointer(arrays["vertex_frames"], shape, f"{where}.vertex_frames")
    obstacle.x = obstacle.frame
    obstacle.frames, obstacle.n_vertices = kept[-1].shape[:2]
    obstacle.frame_dt = arrays.get("frame_dt", 1 / 60)
    between = arrays.get("between", "linear")
    if between not in scenes.BETWEEN:
        raise SceneError(f'{where}: between: {between!r}: expected "linear" or "cubic"')
    obstacle.between = scenes.BETWEEN.index(between)
    if "frame_times" in arrays:
        # the last that is kept are the vertices
        kept.insert(0, scenes.times(arrays, obstacle.frames, where))
        obstacle.frame_time = ffi.cast("double *", kept[0].ctypes.data)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuses a key that is there twice, as the reader does."""
    tree = dict(pairs)
    if len(tree) != len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"{twice}: the key is there twice")
    return tree


def _never(word: str) -> Any:
    raise ValueError(f"{word} is no number of JSON")


def tree_of(text: scenes.Text) -> dict[str, Any]:
    """Returns a scene's keys, in containers that nobody else has. What is not JSON,
    or has a key twice, is refused in the words of the scenes' reader."""
    try:
        text.text.encode()  # which bytes that are not UTF-8 do not let pass
        tree = json.loads(
            text.text.removeprefix("\ufeff"),
            object_pairs_hook=_once,
            parse_constant=_never,
        )
        if not isinstance(tree, dict):
            raise ValueError("expected an object { … }")
    except (ValueError, RecursionError) as error:
        read_scene(text)  # which says in which line and column
        raise SceneError(f"{text.file}: not a scene in JSON: {error}") from error
    return tree


def with_keys(text: scenes.Text, keys: Mapping[str, Any]) -> scenes.Text:
    """Returns the scene with some of its keys replaced."""
    if not keys:
        return text
    tree = {**tree_of(text), **scenes.as_dict(dict(keys))}
    return dataclasses.replace(text, text=scenes.as_text(tree, text.file))
