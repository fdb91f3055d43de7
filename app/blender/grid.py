# SPDX-License-Identifier: Apache-2.0
"""Finds the rows and columns of a mesh that is a rectangular grid of quads."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray


class NoGrid(ValueError):
    """A mesh that is no rectangular grid of quads; the text says why."""


def _opposite(quad: tuple[int, ...], p: int, q: int) -> tuple[int, int]:
    """The neighbours in a quad of p and of q that are across from edge p q."""
    at = quad.index(p)
    if quad[(at + 1) % 4] == q:
        return quad[at - 1], quad[(at + 2) % 4]
    return quad[(at + 1) % 4], quad[(at + 2) % 4]


def _first(quads: list[tuple[int, ...]], count: int) -> tuple[int, int, int, int]:
    """The first corner of the grid, its two neighbours and the quad there."""
    uses = np.bincount(np.array(quads).ravel(), minlength=count)
    corners = np.flatnonzero(uses == 1)
    if len(corners) != 4 or (uses == 0).any():
        raise NoGrid("expected a grid with four corners and no loose vertices")
    corner = int(corners[0])
    at = next(k for k, quad in enumerate(quads) if corner in quad)
    place = quads[at].index(corner)
    a, b = sorted((quads[at][(place + 1) % 4], quads[at][place - 1]))
    return corner, a, b, at


def order(quads: list[tuple[int, ...]], count: int) -> NDArray[np.int64]:
    """Returns the vertices [n, m] of a grid of m columns and n rows.

    Rows begin at the corner vertex of the lowest number and go towards the
    lower of its two neighbours, so that the grids that Blender makes keep their
    order. Raises NoGrid.
    """
    if not quads or any(len(quad) != 4 for quad in quads):
        raise NoGrid("expected faces of four vertices only")
    corner, a, b, at = _first(quads, count)
    sides: dict[frozenset[int], list[int]] = defaultdict(list)
    for k, quad in enumerate(quads):
        for i in range(4):
            sides[frozenset((quad[i], quad[i - 1]))].append(k)
    if any(len(k) > 2 for k in sides.values()):
        raise NoGrid("expected at most two faces at an edge")
    across = _opposite(quads[at], corner, a)[1]
    place = {corner: (0, 0), a: (1, 0), b: (0, 1), across: (1, 1)}
    todo, done = [at], {at}
    while todo:
        quad = quads[todo.pop()]
        for i in range(4):
            p, q = quad[i], quad[i - 1]
            for k in sides[frozenset((p, q))]:
                if k in done:
                    continue
                done.add(k)
                todo.append(k)
                # the grid goes on straight across the edge
                for near, far, back in zip(
                    (p, q),
                    _opposite(quads[k], p, q),
                    _opposite(quad, p, q),
                    strict=True,
                ):
                    x = tuple(
                        2 * n - o for n, o in zip(place[near], place[back], strict=True)
                    )
                    if place.setdefault(far, x) != x:
                        raise NoGrid("its rows and columns do not fit together")
    return _rectangle(place, count)


def _rectangle(place: dict[int, tuple[int, ...]], count: int) -> NDArray[np.int64]:
    """The vertices by their places, which must fill a rectangle from (0, 0)."""
    vertices = np.array(list(place))
    i, j = np.array(list(place.values())).T
    m, n = int(i.max()) + 1, int(j.max()) + 1
    flat = np.unique(i + m * j)
    if min(i.min(), j.min()) < 0 or not len(flat) == m * n == count == len(place):
        raise NoGrid("expected a whole rectangle of quads, without holes")
    rows = np.empty((n, m), np.int64)
    rows[j, i] = vertices
    return rows


def size(x: NDArray[np.float64]) -> tuple[float, float]:
    """The mean lengths, m, of the rows and columns of positions [n, m, 3]."""
    along = np.linalg.norm(np.diff(x, axis=1), axis=2).sum(1).mean()
    across = np.linalg.norm(np.diff(x, axis=0), axis=2).sum(0).mean()
    return float(along), float(across)
