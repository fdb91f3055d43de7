# SPDX-License-Identifier: Apache-2.0
"""Where points are in a mesh of triangles in the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

CHUNK = 1 << 22  # pairs of a point and a triangle at a time


def locate(x: Array, tri: Array, points: Array) -> tuple[Array, Array]:
    """Returns for each of points, [n, 2], the vertices [n, 3] of the triangle that it
    is in, and its weights on them, whose sum is 1. A point in none takes the nearest
    triangle, and weights that continue it.

    Args:
        x: [v, 2]; tri: [k, 3] numbers of vertices, of triangles with area,
            counter-clockwise
    """
    if not len(points):
        return np.zeros((0, 3), np.int64), np.zeros((0, 3))
    grid = _Grid(x, tri)
    best = np.full(len(points), -1, np.int64)
    off = np.full(len(points), np.inf)
    for who, which in grid.pairs(points, 0):
        _keep(best, off, who, which, -_weights(x[tri[which]], points[who]).min(1))
    # those outside by more than rounding take the nearest triangle
    lost = np.flatnonzero(~(off <= 1e-9))
    ring = 1
    while len(lost):
        best[lost], off[lost] = -1, np.inf
        for who, which in grid.pairs(points[lost], ring):
            far = _distance(x[tri[which]], points[lost][who])
            _keep(best, off, lost[who], which, far)
        # a triangle in the next ring of squares may be nearer
        lost = lost[~(off[lost] <= ring * grid.size)]
        ring *= 2
    return tri[best], _weights(x[tri[best]], points)


class _Grid:
    """Triangles by the squares of a grid that their boxes meet."""

    def __init__(self, x: Array, tri: Array) -> None:
        p = x[tri]
        lo, hi = p.min(1), p.max(1)
        self.at = lo.min(0)
        self.size = max(float((hi - lo).mean()), 1e-12)
        self.shape = ((hi.max(0) - self.at) / self.size).astype(np.int64) + 1
        a = ((lo - self.at) / self.size).astype(np.int64)
        b = ((hi - self.at) / self.size).astype(np.int64)
        across = b - a + 1
        count = across.prod(1)
        owner = np.repeat(np.arange(len(tri)), count)
        k = _run(count)
        i, j = k % across[owner, 0], k // across[owner, 0]
        square = (a[owner, 0] + i) + self.shape[0] * (a[owner, 1] + j)
        order = np.argsort(square, kind="stable")
        self.item = owner[order]
        squares = int(self.shape.prod())
        self.first = np.searchsorted(square[order], np.arange(squares + 1))

    def pairs(self, points: Array, ring: int) -> Any:
        """Gives points and triangles, in pieces, of squares at most `ring` apart."""
        at = np.floor((points - self.at) / self.size).astype(np.int64)
        at = np.clip(at, 0, self.shape - 1)
        steps = np.arange(-ring, ring + 1)
        for dj in steps:
            for di in steps:
                square = at + np.array([di, dj])
                there = ((square >= 0) & (square < self.shape)).all(1)
                who = np.flatnonzero(there)
                number = square[who, 0] + self.shape[0] * square[who, 1]
                count = self.first[number + 1] - self.first[number]
                yield from self._pieces(who, number, count)

    def _pieces(self, who: Array, number: Array, count: Array) -> Any:
        ends = np.cumsum(count)
        start = 0
        while start < len(who):
            before = ends[start - 1] if start else 0
            stop = int(np.searchsorted(ends, before + CHUNK, "right"))
            stop = max(stop, start + 1)
            part = slice(start, stop)
            owner = np.repeat(np.arange(start, stop), count[part])
            k = self.first[number[owner]] + _run(count[part])
            yield who[owner], self.item[k]
            start = stop


def _run(count: Array) -> Array:
    """0 … count - 1 for each count, one behind the other."""
    before = np.cumsum(count) - count
    found: Array = np.arange(int(count.sum())) - np.repeat(before, count)
    return found


def _keep(best: Array, off: Array, who: Array, which: Array, value: Array) -> None:
    """Keeps the least value of each point, and of equal ones the first triangle."""
    order = np.lexsort((which, value, who))
    who, which, value = who[order], which[order], value[order]
    first = np.flatnonzero(np.diff(who, prepend=-1))
    better = first[value[first] < off[who[first]]]
    best[who[better]], off[who[better]] = which[better], value[better]


def _weights(p: Array, x: Array) -> Array:
    """Barycentric coordinates [n, 3] of points x in triangles p, [n, 3, 2]."""
    a, b, c = p[:, 0], p[:, 1], p[:, 2]
    area = _cross(b - a, c - a)
    u, v = _cross(b - x, c - x) / area, _cross(c - x, a - x) / area
    return np.stack([u, v, 1 - u - v], 1)


def _cross(a: Array, b: Array) -> Array:
    found: Array = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return found


def _distance(p: Array, x: Array) -> Array:
    """From points x to the sides of triangles p, in which they are not."""
    least = np.full(len(x), np.inf)
    for k in range(3):
        a, side = p[:, k], p[:, (k + 1) % 3] - p[:, k]
        t = ((x - a) * side).sum(1) / (side * side).sum(1)
        near = a + np.clip(t, 0, 1)[:, None] * side
        least = np.minimum(least, np.linalg.norm(x - near, axis=1))
    return least
