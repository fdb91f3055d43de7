# SPDX-License-Identifier: Apache-2.0
"""Warns of cloths that are stretched beyond what fabrics bear, as the tool does at the
end of a run (app/write/stretch.c): springs do not tear, and such steps are clean."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import warn

TWICE = 2
APART = 10  # steps between two looks, which thus cost little beside the steps


def _sides(body: Any, triangles: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Returns the sides of a cloth's cells, [n, 2] vertices, and their lengths at
    rest, m. Diagonals are none."""
    (m, n), (width, height) = body.particles, body.size
    pairs = triangles[body.triangles][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    by = pairs[:, 1] - pairs[:, 0]
    along = (by == 1) | (by == m)
    rest = np.where(by == 1, width / (m - 1), height / (n - 1))
    return pairs[along], rest[along]


class Stretch:
    """What was seen of a world's cloths so far."""

    def __init__(self) -> None:
        """Nothing."""
        self._next = 0
        self._told: set[str] = set()
        self._of: Any = None  # the triangles that the sides are of
        self._sides: list[tuple[Any, NDArray[Any], NDArray[Any]]] = []

    def look(
        self, step: int, x: Any, triangles: NDArray[Any], bodies: Sequence[Any]
    ) -> None:
        """Looks at positions after a step, once in ten steps, and warns of each cloth
        with a side of a cell that is more than twice as long as at rest, once."""
        if self._next - APART < step < self._next:
            return
        self._next = step + APART
        if triangles is not self._of:
            cloths = [body for body in bodies if body.kind == "cloth"]
            self._of = triangles
            self._sides = [(body, *_sides(body, triangles)) for body in cloths]
        x = np.asarray(x)
        for body, sides, rest in self._sides:
            if body.name in self._told or not len(sides):
                continue
            along = x[sides[:, 0]] - x[sides[:, 1]]
            most = float((np.sqrt((along**2).sum(axis=1)) / rest).max())
            if most > TWICE:
                self._told.add(body.name)
                warn(
                    f"{body.name}: note: after step {step} it is stretched to "
                    f"{most:.3g} times its length, where fabrics tear; a stiffer "
                    "material or its limit of strain holds it"
                )
