# SPDX-License-Identifier: Apache-2.0
"""Meshes of files: what other programs made, as obstacles, cloths and frames."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import scene as scenes
from ._core import ffi
from ._define import read_scene
from ._endings import ALEMBIC, NUMPY, USD
from ._meshes import are_of
from .errors import SceneError, need

Array = NDArray[Any]

FPS = 60  # frames a second that are read of an Alembic file, which has times alone


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """A mesh of triangles, with +y up.

    Attributes:
        name: in its file
        vertices: [n, 3] m, at the first frame
        triangles: [k, 3] numbers of vertices
        frames: [f, n, 3] m, of a mesh that moves or deforms, else None
        frame_dt: s between frames
        size: of a sheet at rest, m, where the file tells it
        kind: "cloth" or "obstacle", where the file tells it
    """

    name: str
    vertices: Array
    triangles: Array
    frames: Array | None = None
    frame_dt: float = 1 / 60
    size: tuple[float, float] | None = None
    kind: str | None = None

    def __repr__(self) -> str:
        """The mesh in one line."""
        moving = "" if self.frames is None else f", {len(self.frames)} frames"
        return (
            f"<drape.Mesh {self.name!r}: {len(self.vertices)} vertices, "
            f"{len(self.triangles)} triangles{moving}>"
        )

    def obstacle(self, **keys: Any) -> scenes.Obstacle:
        """Returns the mesh as an obstacle, which moves as its frames do; keys are
        further ones of an obstacle."""
        arrays = (
            {"vertices": self.vertices}
            if self.frames is None
            else {"vertex_frames": self.frames, "frame_dt": self.frame_dt}
        )
        name = {"name": self.name} if self.name else {}
        return scenes.Obstacle(
            **{**name, "triangles": self.triangles, **arrays, **keys}
        )

    def cloth(self, **keys: Any) -> scenes.Cloth:
        """Returns the mesh as a cloth that starts where the mesh is; keys are further
        ones of a cloth. The mesh must be a rectangular grid whose vertices are in
        the order of its rows, as programs make planes; its size at rest is that in
        the file, or the mean length of its rows and columns."""
        m, n = grid_of(self.triangles, len(self.vertices), self.name)
        x = np.asarray(self.vertices, np.float64).reshape(n, m, 3)
        across = [
            float(np.linalg.norm(np.diff(x, axis=axis), axis=2).sum(1 - axis).mean())
            for axis in (1, 0)
        ]
        made = {
            "name": self.name,
            "particles": [m, n],
            "size": list(self.size or across),
            "positions": np.asarray(self.vertices, np.float64),
        }
        return scenes.Cloth(**{**made, **keys})


def grid_of(triangles: Array, count: int, name: str) -> tuple[int, int]:
    """Returns the particles (m, n) of a grid of triangles whose vertices are in the
    order of its rows; a SceneError if the mesh is none."""
    tri = np.asarray(triangles)
    apart = np.unique(np.abs(tri - np.roll(tri, 1, axis=1)))
    for m in (int(each) for each in apart if each >= 2 and count % each == 0):
        n = count // m
        cells = (
            np.ptp(tri % m, axis=1).max() <= 1 and np.ptp(tri // m, axis=1).max() <= 1
        )
        if n >= 2 and cells and len(tri) == 2 * (m - 1) * (n - 1):
            return m, n
    raise SceneError(
        f"{name}: {count} vertices, {len(tri)} triangles: expected a whole rectangular "
        "grid whose vertices are in the order of its rows"
    )


def read_meshes(path: str | os.PathLike[str]) -> dict[str, Mesh]:
    """Reads the meshes of a file by their names, in metres and with +y up.

    Args:
        path: USD (the extra `export`) or Alembic (the extra `alembic`), with the
            frames of what moves; .npz of arrays `vertices`, `positions` or `frames`
            and `triangles` or `faces`, or as drape writes it; or what the tool
            reads, as one mesh: .ply, .off, .obj, .stl, .gltf, .glb, .dae, .fbx

    Raises:
        SceneError: it is no such file, or has no mesh
        Error: a package that its format needs is not installed
    """
    file = Path(path)
    ending = file.suffix.lower()
    if not file.is_file():
        raise SceneError(f"{file}: there is no such file")
    reader: Callable[[Path], list[Mesh]] = _by_tool
    if ending in NUMPY:
        reader = _npz
    elif ending in USD:
        reader = need("drape.export.usd_read", ending, "usd-core").read
    elif ending in ALEMBIC:
        reader = need("drape.export.alembic_read", ending, "bpy").read
    found: dict[str, Mesh] = {}
    for mesh in reader(file):
        name, k = mesh.name, 2
        while name in found:
            name, k = f"{mesh.name} {k}", k + 1
        found[name] = mesh
    if not found:
        raise SceneError(f"{file}: there is no mesh in it")
    return found


def _by_tool(file: Path) -> list[Mesh]:
    """Reads a mesh as a scene's obstacle."""
    scene = {"cloths": [{"size": [1, 1]}], "obstacles": [{"mesh": str(file.resolve())}]}
    made = read_scene(scenes.read(scene), notes=False)
    body = getattr(made, "def").obstacles[0]
    n, f = int(body.n_vertices), int(body.frames)
    tri = np.frombuffer(ffi.buffer(body.tri, body.n_triangles * 12), np.int32)
    x = np.frombuffer(ffi.buffer(body.frame if f else body.x, (f or 1) * n * 24))
    frames = x.reshape(-1, n, 3).copy()
    triangles = tri.reshape(-1, 3).copy()
    moving = (frames, float(body.frame_dt)) if f > 1 else (None, 1 / 60)
    return [Mesh(file.stem, frames[0], triangles, *moving)]


def _npz(file: Path) -> list[Mesh]:
    """Reads arrays; where drape has written them, each body is a mesh."""
    try:
        with np.load(file, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
    except (OSError, ValueError) as error:
        raise SceneError(f"{file}: not a file of NumPy's arrays: {error}") from None
    names = [name for name in ("frames", "positions", "vertices") if name in arrays]
    faces = next(
        (arrays[name] for name in ("triangles", "faces") if name in arrays), None
    )
    if not names or faces is None:
        raise SceneError(
            f"{file}: {', '.join(arrays)}: expected arrays vertices, positions or "
            "frames, and triangles or faces"
        )
    x = scenes.array(arrays[names[0]], (None,) * arrays[names[0]].ndim, f"{file}: x")
    if x.ndim not in (2, 3) or x.shape[-1] != 3:
        raise SceneError(f"{file}: {names[0]}: {x.shape}; expected n × 3 or f × n × 3")
    x = x[None] if x.ndim == 2 else x
    tri = scenes.array(faces, (None, 3), f"{file}: triangles", np.int32)
    if not are_of(tri, max(x.shape[1], _all(arrays))):
        raise SceneError(f"{file}: triangles: expected vertices 0 to {x.shape[1] - 1}")
    dt = float(arrays.get("frame_dt", 1 / 60))
    if "body_vertices" not in arrays:
        return [Mesh(file.stem, x[0], tri, x if len(x) > 1 else None, dt)]
    found = []
    for k, (start, stop) in enumerate(arrays["body_vertices"]):
        first, last = arrays["body_triangles"][k]
        kind = str(arrays["body_kinds"][k])
        # frames may be of the cloths alone, which come first
        part = x if stop <= x.shape[1] else arrays["positions"][None]
        mine = part[:, start:stop].astype(np.float64)
        size = tuple(float(each) for each in arrays["body_size"][k])
        found.append(
            Mesh(
                str(arrays["body_names"][k]),
                mine[0],
                tri[first:last] - start,
                mine if (mine != mine[0]).any() else None,
                dt,
                (size[0], size[1]) if kind == "cloth" else None,
                kind,
            )
        )
    return found


def _all(arrays: dict[str, Array]) -> int:
    """Returns the number of vertices of all bodies, where drape has written them."""
    return int(arrays["body_vertices"].max()) if "body_vertices" in arrays else 0


def merged(meshes: dict[str, Mesh], where: str) -> dict[str, Any]:
    """Returns the arrays of an obstacle of all meshes of a file."""
    parts = list(meshes.values())
    moving = [each for each in parts if each.frames is not None]
    shift = np.cumsum([0, *(len(each.vertices) for each in parts)])
    tri = np.concatenate([p.triangles + s for p, s in zip(parts, shift, strict=False)])
    if not moving:
        vertices = np.concatenate([each.vertices for each in parts])
        return {"vertices": vertices, "triangles": tri}
    most = max(len(each.frames) for each in moving if each.frames is not None)
    if len({each.frame_dt for each in moving}) > 1:
        raise SceneError(f"{where}: its meshes have different times between frames")

    def frames(part: Mesh) -> Array:
        x = part.vertices[None] if part.frames is None else part.frames
        return np.concatenate([x, np.repeat(x[-1:], most - len(x), axis=0)])

    x = np.concatenate([frames(each) for each in parts], axis=1)
    return {"vertex_frames": x, "triangles": tri, "frame_dt": moving[0].frame_dt}
