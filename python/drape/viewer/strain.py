# SPDX-License-Identifier: Apache-2.0
"""The strain of a cloth, and its colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drape.export.mesh import Array
from drape.export.run import Body

# Linear colours of the scale: most pressed, unstrained, most stretched.
SCALE = np.array([[0.02, 0.06, 0.60], [0.30, 0.30, 0.29], [0.60, 0.02, 0.02]])


def principal(body: Body, x: Array) -> tuple[Array, Array]:
    """The least and the largest principal strain of each triangle of a cloth.

    The map from the cloth at rest to its place has two principal stretches, the
    singular values of its gradient F; a strain is a stretch minus 1.
    """
    if body.uv is None or body.size is None:
        raise ValueError(f"{body.name}: an obstacle has no strain")
    rest = (body.uv.astype(np.float64) * body.size)[body.faces]
    now = x.astype(np.float64)[body.faces]
    flat = np.stack([rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]], 2)
    edge = np.stack([now[:, 1] - now[:, 0], now[:, 2] - now[:, 0]], 2)
    gradient = edge @ np.linalg.inv(flat)
    square = gradient.transpose(0, 2, 1) @ gradient
    half = (square[:, 0, 0] + square[:, 1, 1]) / 2
    apart = np.hypot((square[:, 0, 0] - square[:, 1, 1]) / 2, square[:, 0, 1])
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
