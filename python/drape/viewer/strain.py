# SPDX-License-Identifier: Apache-2.0
"""The strain of a cloth, and its colours."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drape.export.mesh import Array
from drape.export.run import Body

# Linear colours of the scale: most pressed, unstrained, most stretched.
SCALE = np.array([[0.02, 0.06, 0.60], [0.30, 0.30, 0.29], [0.60, 0.02, 0.02]])


@lru_cache(maxsize=64)
def _measure(body: Body) -> Array:
    """What gives F^T F of each triangle by its edges now: [3, 3, triangles], of which
    row k has the factors of a·a, a·b and b·b in entry 11, 12 or 22."""
    if body.rest is None:
        raise ValueError(f"{body.name}: an obstacle has no strain")
    x, y = body.rest.T
    i, j, k = body.faces.T
    ax, ay, bx, by = x[j] - x[i], y[j] - y[i], x[k] - x[i], y[k] - y[i]
    # the inverse of the edges at rest; its rows are r and s
    rx, ry, sx, sy = np.array([by, -bx, -ay, ax]) / (ax * by - ay * bx)
    rows = [rx * rx, 2 * rx * sx, sx * sx], [rx * ry, rx * sy + ry * sx, sx * sy]
    return np.array([*rows, [ry * ry, 2 * ry * sy, sy * sy]])


def principal(body: Body, x: Array) -> tuple[Array, Array]:
    """The least and the largest principal strain of each triangle of a cloth.

    The map from the cloth at rest to its place has two principal stretches, the
    singular values of its gradient F; a strain is a stretch minus 1.
    """
    measure = _measure(body)
    now = np.ascontiguousarray(x.T, np.float64)
    i, j, k = body.faces.T
    a, b = now[:, j] - now[:, i], now[:, k] - now[:, i]
    edges = (a * a).sum(0), (a * b).sum(0), (b * b).sum(0)
    one, mixed, two = (
        sum(f * e for f, e in zip(m, edges, strict=True)) for m in measure
    )
    half = (one + two) / 2
    apart = np.hypot((one - two) / 2, mixed)
    least = np.sqrt(np.maximum(half - apart, 0)) - 1
    return least, np.sqrt(half + apart) - 1


def at_vertices(body: Body, x: Array) -> NDArray[np.float32]:
    """The strain of each vertex of a cloth: that of larger size of the two.

    A vertex takes the mean of its triangles.
    """
    least, largest = principal(body, x)
    strain = np.where(-least > largest, least, largest)
    corner = body.faces.ravel()
    total = np.bincount(corner, np.repeat(strain, 3), len(x))
    return (total / np.bincount(corner, minlength=len(x))).astype(np.float32)


def colours(strain: Array, limit: float) -> NDArray[np.float32]:
    """Linear colours [vertices, 3]: blue is pressed, red is stretched by `limit`."""
    place = np.clip(strain / limit, -1, 1)
    rgb = [np.interp(place, [-1, 0, 1], SCALE[:, k]) for k in range(3)]
    return np.stack(rgb, 1).astype(np.float32)
