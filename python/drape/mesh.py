# SPDX-License-Identifier: Apache-2.0
"""Exact queries of triangle meshes, which need no world."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import ffi, lib
from ._meshes import mesh_of
from .errors import SceneError, check
from .scene import array

KINDS = {"vf": 0, "ee": 1}


@dataclass(frozen=True, repr=False)
class Audit:
    """The intersecting pairs of triangles of a mesh.

    Attributes:
        pairs: [count, 2] numbers of triangles, ascending
        degenerate: triangles without area, which are in no pair
    """

    pairs: NDArray[np.int32]
    degenerate: int

    @property
    def count(self) -> int:
        """How many pairs intersect."""
        return len(self.pairs)

    def __repr__(self) -> str:
        """How many pairs intersect, and how many triangles have no area."""
        flat = f", {self.degenerate} degenerate triangles" if self.degenerate else ""
        return f"<drape.Audit: {self.count} intersecting pairs{flat}>"


@dataclass(frozen=True, repr=False)
class Touches:
    """What touches while a mesh moves.

    Attributes:
        kind: [count] 0: a vertex and a face, 1: two edges
        vertices: [count, 4] the vertex and the face's, or those of both edges
        toi: [count] when they first touch, 0 … 1, at most 2^-30 too early
        candidates: pairs of a vertex and a face, and of edges, decided
    """

    kind: NDArray[np.int32]
    vertices: NDArray[np.int32]
    toi: NDArray[np.float64]
    candidates: tuple[int, int]

    def __len__(self) -> int:
        """How many pairs touch."""
        return len(self.kind)

    def __repr__(self) -> str:
        """How many pairs touch."""
        return f"<drape.Touches: {len(self)} pairs of {sum(self.candidates)} decided>"


class _Mesh:
    """A drape_mesh and the arrays that it points to."""

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike, threads: int) -> None:
        self.x = array(vertices, (None, 3), "vertices")
        self.tri = array(triangles, (None, 3), "triangles", kind=np.int32)
        self.c = ffi.new("drape_mesh *")
        self.c.nv, self.c.nt = len(self.x), len(self.tri)
        self.c.x = ffi.cast("double (*)[3]", self.x.ctypes.data)
        self.c.tri = ffi.cast("int32_t (*)[3]", self.tri.ctypes.data)
        self.c.threads = threads


def audit(
    vertices: Any,
    triangles: ArrayLike | None = None,
    group: ArrayLike | None = None,
    *,
    threads: int = 0,
) -> Audit:
    """Finds the intersecting pairs of triangles of a mesh, exactly.

    Args:
        vertices: [n, 3] m; or, without triangles, a mesh as `Obstacle` takes it
        triangles: [k, 3] numbers of vertices
        group: [k] 0: of an obstacle; two such triangles are not compared
        threads: 0: as many as processors; the number changes no result
    """
    if triangles is None:
        vertices, triangles = mesh_of(vertices, "audit")
    mesh = _Mesh(vertices, triangles, threads)
    if group is not None:
        groups = array(group, (len(mesh.tri),), "group", kind=np.int32)
        mesh.c.group = ffi.cast("int32_t *", groups.ctypes.data)
    found, degenerate = ffi.new("int64_t *"), ffi.new("int64_t *")
    room = 1024
    while True:
        pairs = np.empty((room, 2), np.int32)
        at = ffi.cast("int32_t (*)[2]", pairs.ctypes.data)
        check(lib.drape_audit(mesh.c, room, at, found, degenerate), "audit")
        if found[0] <= room:
            return Audit(pairs[: found[0]].copy(), degenerate[0])
        room = found[0]


def _kind(kind: str) -> int:
    if kind not in KINDS:
        raise SceneError(f'ccd: kind {kind!r}: expected "vf" or "ee"')
    return KINDS[kind]


def ccd(kind: str, x0: ArrayLike, x1: ArrayLike) -> NDArray[np.float64]:
    """Decides exactly whether primitives touch that move linearly.

    Args:
        kind: "vf": vertex 0 and face 1 2 3, or "ee": edges 0 1 and 2 3
        x0, x1: [n, 4, 3], or [4, 3], at time 0 and at time 1

    Returns:
        [n], or one number: when they first touch, 0 … 1, at most 2^-30 too
        early and never too late; NaN: they do not touch
    """
    number = _kind(kind)
    single = np.ndim(x0) == 2
    a = array(np.asarray(x0)[None] if single else x0, (None, 4, 3), "x0")
    b = array(np.asarray(x1)[None] if single else x1, (len(a), 4, 3), "x1")
    hit, toi = np.zeros(len(a), np.uint8), np.full(len(a), np.nan)
    bad = ffi.new("int64_t *")
    status = lib.core_ccd(
        number,
        len(a),
        ffi.cast("double (*)[4][3]", a.ctypes.data),
        ffi.cast("double (*)[4][3]", b.ctypes.data),
        ffi.cast("uint8_t *", hit.ctypes.data),
        ffi.cast("double *", toi.ctypes.data),
        bad,
    )
    check(status, f"ccd: query {bad[0]}")
    toi[hit == 0] = np.nan
    return toi[0] if single else toi


def ccd_mesh(
    vertices0: ArrayLike,
    vertices1: ArrayLike,
    triangles: ArrayLike,
    *,
    threads: int = 0,
) -> Touches:
    """Finds all that touches while a mesh moves linearly: each vertex and face,
    and each two edges, that share no vertex.

    Args:
        vertices0, vertices1: [n, 3] m, at time 0 and at time 1
        triangles: [k, 3] numbers of vertices
        threads: 0: as many as processors; the number changes no result
    """
    mesh = _Mesh(vertices0, triangles, threads)
    end = array(vertices1, mesh.x.shape, "vertices1")
    candidates, found = ffi.new("int64_t[2]"), ffi.new("core_touches *")
    try:
        status = lib.drape_ccd_frames(
            mesh.c,
            ffi.cast("double (*)[3]", end.ctypes.data),
            ffi.addressof(lib, "core_touch_add"),
            ffi.cast("void *", found),
            candidates,
        )
        check(status, "ccd_mesh")
        rows = _touches(found)
    finally:
        lib.core_touches_free(found)
    both = (candidates[0], candidates[1])
    return Touches(rows["kind"].copy(), rows["v"].copy(), rows["toi"].copy(), both)


def _touches(found: Any) -> Any:
    """Returns a copy of the rows of a core_touches."""
    row = np.dtype([("toi", "f8"), ("kind", "i4"), ("v", "i4", 4), ("unused", "i4")])
    size = found.count * row.itemsize
    if not size:
        return np.empty(0, row)
    return np.frombuffer(bytes(ffi.buffer(found.touch, size)), row)
