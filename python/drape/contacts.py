# SPDX-License-Identifier: Apache-2.0
"""Pairs in contact, as a world tells them and as a run's files keep them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# A drape_contact.
ROW = np.dtype(
    [
        ("vertex", "i4", 4),
        ("kind", "i4"),
        ("body", "i4", 2),
        ("unused", "i4"),
        ("weight", "f8", 4),
        ("normal", "f8", 3),
        ("gap", "f8"),
        ("impulse", "f8", 3),
    ]
)


@dataclass(frozen=True, eq=False)
class Pairs:
    """The pairs in contact in the last slice of a step, sides A and B: a vertex
    and a face, or two edges. A pair that met again in the slice is listed twice.

    Attributes:
        kind: [n] 0: A is a vertex and B a face, 1: both are edges
        vertices: [n, 4] of the scene: A's, then B's
        bodies: [n, 2] numbers of A's and of B's body
        weights: [n, 4] those of A add to 1, those of B to -1: the point of
            contact on A is the sum of weight · x over A's vertices
        normals: [n, 3] of length 1, from B to A
        gaps: [n] m, along the normal, at the start of the slice
        impulses: [n, 3] N·s, that A got from B, with friction
        dt: s, length of the slice: an impulse divided by it is the mean force
    """

    kind: NDArray[np.int32]
    vertices: NDArray[np.int32]
    bodies: NDArray[np.int32]
    weights: NDArray[np.float64]
    normals: NDArray[np.float64]
    gaps: NDArray[np.float64]
    impulses: NDArray[np.float64]
    dt: float

    def __len__(self) -> int:
        """How many pairs there are."""
        return len(self.kind)


@dataclass(frozen=True, eq=False)
class Contacts(Pairs):
    """The pairs of the last step of a `World`. A body's number is that in
    `World.bodies`.

    Attributes:
        body_impulses: [bodies, 3] N·s, that each body got in all
    """

    body_impulses: NDArray[np.float64]
