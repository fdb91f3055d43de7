# SPDX-License-Identifier: Apache-2.0
"""Finds the rows and columns of a mesh that is a grid of quads, with or without holes."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray


class NoGrid(ValueError):
    """A mesh that is no grid of quads; the text says why."""


def _opposite(quad: tuple[int, ...], p: int, q: int) -> tuple[int, int]:
    """The neighbours in a quad of p and of q that are across from edge p q."""
    at = quad.index(p)
    if quad[(at + 1) % 4] == q:
        return quad[at - 1], quad[(at + 2) % 4]
    return quad[(at + 1) % 4], quad[(at + 2) % 4]


def order(quads: list[tuple[int, ...]], count: int) -> NDArray[np.int64]:
    """Returns the vertices [n, m] of a grid of m columns and n rows; -1 where it has
    none.

    Rows go from the vertex of the lowest number towards the lower of two neighbours
    of it, so that the grids that Blender makes keep their order. Raises NoGrid.
    """
    if not quads or any(len(quad) != 4 for quad in quads):
        raise NoGrid("expected faces of four vertices only")
    first = min(map(min, quads))
    at = next(k for k, quad in enumerate(quads) if first in quad)
    corner = quads[at].index(first)
    a, b = sorted((quads[at][(corner + 1) % 4], quads[at][corner - 1]))
    sides: dict[frozenset[int], list[int]] = defaultdict(list)
    for k, quad in enumerate(quads):
        for i in range(4):
            sides[frozenset((quad[i], quad[i - 1]))].append(k)
    if any(len(k) > 2 for k in sides.values()):
        raise NoGrid("expected at most two faces at an edge")
    across = _opposite(quads[at], first, a)[1]
    place = {first: (0, 0), a: (1, 0), b: (0, 1), across: (1, 1)}
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
    if len(place) != count:
        raise NoGrid("expected one piece without loose vertices")
    return _laid(place)


def _laid(place: dict[int, tuple[int, ...]]) -> NDArray[np.int64]:
    """The vertices by their places, of which each has one."""
    vertices = np.array(list(place))
    at = np.array(list(place.values()))
    at -= at.min(0)
    i, j = at.T
    m, n = int(i.max()) + 1, int(j.max()) + 1
    if len(np.unique(i + m * j)) != len(at):
        raise NoGrid("it lies twice on its rows and columns")
    rows = np.full((n, m), -1)
    rows[j, i] = vertices
    return rows


def missing(
    rows: NDArray[np.int64], quads: list[tuple[int, ...]]
) -> list[tuple[int, int]]:
    """The cells (column, row) of a grid that are no quads."""
    there = {frozenset(quad) for quad in quads}
    n, m = rows.shape
    return [
        (i, j)
        for j in range(n - 1)
        for i in range(m - 1)
        if frozenset(rows[j : j + 2, i : i + 2].ravel().tolist()) not in there
    ]


def size(x: NDArray[np.float64]) -> tuple[float, float, float]:
    """The lengths, m, of the rows and columns of positions [n, m, 3], by the mean of
    their edges, and how uneven these are: the root mean square of their strains
    against it. NaN: there is no vertex."""
    along = np.linalg.norm(np.diff(x, axis=1), axis=2)
    across = np.linalg.norm(np.diff(x, axis=0), axis=2)
    h, g = float(np.nanmean(along)), float(np.nanmean(across))
    strains = np.concatenate([along.ravel() / h - 1, across.ravel() / g - 1])
    uneven = float(np.sqrt(np.nanmean(strains**2)))
    return h * along.shape[1], g * across.shape[0], uneven
