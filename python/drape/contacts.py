# SPDX-License-Identifier: Apache-2.0
"""Pairs in contact, as a world tells them and as a run's files keep them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

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


@dataclass(frozen=True, eq=False, repr=False)
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

    def __repr__(self) -> str:
        """How many pairs there are, and how long the slice was."""
        name = f"drape.{type(self).__name__}"
        return f"<{name}: {len(self)} pairs in {self.dt:.4g} s>"

    def places(self, positions: Any) -> NDArray[np.float64]:
        """Returns where pairs touch on side A, [n, 3] m, with the scene's vertices at
        these positions, [vertices, 3] m."""
        weight = self.weights.copy()
        # side A has the vertex of kind 0, and the first edge of kind 1
        weight[:, 2:] = 0
        weight[self.kind == 0, 1] = 0
        x = np.asarray(positions, np.float64)[self.vertices]
        found: NDArray[np.float64] = (weight[:, :, None] * x).sum(1)
        return found


@dataclass(frozen=True, eq=False, repr=False)
class Contacts(Pairs):
    """The pairs of the last step of a `World`. A body's number is that in
    `World.bodies`. A force is the mean of the step's last slice.

    Attributes:
        body_impulses: [bodies, 3] N·s, that each body got in all
        count: vertices of the scene
    """

    body_impulses: NDArray[np.float64]
    count: int

    @property
    def body_forces(self) -> NDArray[np.float64]:
        """[bodies, 3] N, on each body from all that touches it."""
        return self.body_impulses / (self.dt or 1)

    def body_torques(self, about: ArrayLike, positions: Any) -> NDArray[np.float64]:
        """Returns the torque on each body from all that touches it, [bodies, 3] N·m.

        Args:
            about: m, the point that torques are about: one [3], or [bodies, 3]
            positions: [vertices, 3] m, `World.positions`
        """
        shape = self.body_impulses.shape
        centre = np.broadcast_to(np.asarray(about, np.float64), shape)
        torque = np.zeros(shape)
        places = self.places(positions)
        force = self.impulses / (self.dt or 1)
        for side, sign in ((0, 1), (1, -1)):
            who = self.bodies[:, side]
            turned = np.cross(places - centre[who], sign * force)
            np.add.at(torque, who, turned)
        return torque

    def forces(self) -> NDArray[np.float64]:
        """Returns the force of contacts on each vertex of the scene, [vertices, 3]
        N. Those of a body's vertices add to its `body_forces`."""
        found = np.zeros((self.count, 3))
        shares = self.weights[:, :, None] * (self.impulses / (self.dt or 1))[:, None]
        np.add.at(found, self.vertices, shares)
        return found
