# SPDX-License-Identifier: Apache-2.0
"""Normals, colours and names of a body, for files that want them."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drape.export.run import Body

Array = NDArray[np.floating[Any]]

# Linear colours: the outer one of each cloth, as in app/render/paint.c, and that of
# obstacles, as in `drape render`.
CLOTHS = (
    (0.42, 0.018, 0.028),
    (0.020, 0.12, 0.34),
    (0.45, 0.26, 0.030),
    (0.020, 0.24, 0.13),
)
STONE = (0.60, 0.555, 0.49)
# An edge of an obstacle that is sharper than this stays an edge.
SHARP = np.cos(np.radians(40))


def colour(body: Body, number: int) -> tuple[float, float, float]:
    """The linear colour of body `number`: the scene's, or that of its kind."""
    if body.colour is not None:
        r, g, b = linear(np.array(body.colour)).tolist()
        return r, g, b
    return CLOTHS[number % len(CLOTHS)] if body.kind == "cloth" else STONE


def linear(rgb: Array) -> Array:
    """Parts of sRGB colours, 0 to 1, as linear ones."""
    bright = ((rgb + 0.055) / 1.055) ** 2.4
    return np.where(rgb <= 0.04045, rgb / 12.92, bright)


def _unit(v: Array) -> Array:
    length = np.sqrt((v * v).sum(-1, keepdims=True))
    unit: Array = np.divide(v, length, out=np.zeros_like(v), where=length > 0)
    return unit


def _corner_sum(x: Array, faces: NDArray[np.int32]) -> tuple[Array, Array]:
    """Unit normals of vertices, weighted by angles, and of triangles."""
    p = x.astype(np.float64)[faces]
    flat = _unit(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    total = np.zeros((len(x), 3))
    for k in range(3):
        a = _unit(p[:, (k + 1) % 3] - p[:, k])
        b = _unit(p[:, (k + 2) % 3] - p[:, k])
        angle = np.arccos(np.clip((a * b).sum(1), -1, 1))
        for i in range(3):
            total[:, i] += np.bincount(faces[:, k], angle * flat[:, i], len(x))
    return _unit(total), flat


def vertex_normals(x: Array, faces: NDArray[np.int32]) -> NDArray[np.float32]:
    """Unit normals [vertices, 3]: the mean of the triangles', weighted by angles."""
    return _corner_sum(x, faces)[0].astype(np.float32)


def sharp_corners(x: Array, faces: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Whether the corner [triangles, 3] is at an edge of the shape.

    There the triangle's own normal is shown: a box has flat faces, a ball is
    round.
    """
    smooth, flat = _corner_sum(x, faces)
    sharp: NDArray[np.bool_] = (smooth[faces] * flat[:, None]).sum(2) < SHARP
    return sharp


def corner_normals(
    x: Array, faces: NDArray[np.int32], sharp: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Unit normals [triangles, 3, 3] of the corners."""
    smooth, flat = _corner_sum(x, faces)
    return np.where(sharp[:, :, None], flat[:, None], smooth[faces]).astype(np.float32)


def identifiers(names: list[str]) -> list[str]:
    """A different identifier of ASCII letters, digits and _ for each name."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name) or "_"
        plain = "_" + plain if plain[0].isdigit() else plain
        given, k = plain, 2
        while given in found:
            given, k = f"{plain}_{k}", k + 1
        found.append(given)
    return found
