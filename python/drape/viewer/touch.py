# SPDX-License-Identifier: Apache-2.0
"""The controls of a world that is computed while it is shown: to drag what is there,
and to change gravity, wind and fabric."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from drape._define import tree_of
from drape.fabrics import materials
from drape.viewer.live import Live
from drape.world import World

AS_IT_IS = "as in the scene"


class Touch:
    """The folder of controls, and what they tell the world."""

    def __init__(self, server: viser.ViserServer, source: Live) -> None:
        """Adds the controls to the page."""
        self.source, gui = source, server.gui
        with gui.add_folder("Touch"):
            gui.add_markdown("Drag cloth, or a body, by the mouse.")
            self.restart: Any = gui.add_button("Restart", hint="key R")
            g = [float(each) for each in source.world.gravity]
            self.gravity: Any = gui.add_vector3(
                "Gravity, m/s²", (g[0], g[1], g[2]), step=0.1
            )
            wind = tree_of(source.world._text).get("wind") or {}
            x, y, z = (float(each) for each in wind.get("velocity", (0, 0, 0)))
            self.wind: Any = gui.add_vector3("Wind, m/s", (x, y, z), step=0.1)
            names = (AS_IT_IS, *sorted(materials()))
            self.fabric: Any = gui.add_dropdown("Fabric", names)
        self._first = [(each, each.value) for each in (self.gravity, self.wind)]
        self.gravity.on_update(lambda _: self._set_gravity())
        self.wind.on_update(lambda _: self._set_wind())
        self.fabric.on_update(lambda _: self._set_fabric())
        self.restart.on_click(lambda _: self.again())

    def again(self) -> None:
        """Puts the world and the controls back to the start."""
        for each, value in self._first:
            each.value = value
        self.fabric.value = AS_IT_IS
        self.source.restart()

    def _set_gravity(self) -> None:
        value = list(self.gravity.value)
        self.source.do(lambda world: world.set_gravity(value))

    def _set_wind(self) -> None:
        value = list(self.wind.value)

        def blow(world: World) -> None:
            if np.any(value) or tree_of(world._text).get("wind"):
                world.set_wind({"velocity": value})

        self.source.do(blow)

    def _set_fabric(self) -> None:
        name = str(self.fabric.value)
        if name == AS_IT_IS:
            return

        def sew(world: World) -> None:
            for body in world.bodies:
                if body.kind == "cloth":
                    world.set_material(body, name)

        self.source.do(sew)

    def drag(self, handle: Any, number: int) -> None:
        """Lets a body, which is shown by this handle, be dragged by the mouse."""
        source = self.source

        async def moved(event: Any) -> None:  # async: in their order
            if event.phase == "start":
                source.grab(number, event.start_position)
            elif event.phase == "update":
                source.pull(event.end_position)
            else:
                source.drop()

        handle.on_drag(moved)
