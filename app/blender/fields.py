# SPDX-License-Identifier: Apache-2.0
"""Blender's force fields: those of kind Wind become drape's wind."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .cloth import to_drape


class Winds:
    """The winds of a scene, which add up: air that moves along the z axis of each by
    its strength, m/s, everywhere.

    Attributes:
        velocities: [3] m/s of drape, one a frame
        notes: on fields that are none, and on what winds have no effect by
    """

    def __init__(self, scene: Any) -> None:
        """Finds the fields of objects that Blender computes."""
        graph = bpy.context.evaluated_depsgraph_get()
        fields = [
            o
            for o in scene.objects
            if o.field
            and o.field.type != "NONE"
            and o.evaluated_get(graph).is_evaluated
        ]
        fields.sort(key=lambda each: each.name)
        self.things = [o for o in fields if o.field.type == "WIND"]
        self.velocities: list[NDArray[np.float64]] = []
        self.notes = [
            f"{o.name}: a force field of kind {o.field.type.title()} has no effect; "
            "drape has wind only"
            for o in fields
            if o not in self.things
        ]
        for o in self.things:
            f = o.field
            idle = {
                "noise": f.noise > 0,
                "falloff": f.falloff_power > 0 or f.use_max_distance,
            }
            words = " and ".join(name for name in idle if idle[name])
            if words:
                self.notes.append(
                    f"{o.name}: its {words} has no effect: drape's wind is the same "
                    "everywhere"
                )

    def sample(self, graph: Any) -> None:
        """Adds the wind that there is now."""
        total = np.zeros(3)
        for thing in self.things:
            shown = thing.evaluated_get(graph)
            axis = np.array(shown.matrix_world)[:3, 2]
            total += axis / np.linalg.norm(axis) * shown.field.strength
        self.velocities.append(to_drape(total))

    def blow(self, world: Any, frame: int) -> None:
        """Tells a world the wind of a frame, counted from the first one."""
        if not np.array_equal(self.velocities[frame], self.velocities[frame - 1]):
            world.set_wind({"velocity": self.velocities[frame]})
