# SPDX-License-Identifier: Apache-2.0
"""What is about the bodies on a page: camera, light, ground and axes; and bars that
say what a colour means."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from drape.viewer.pattern import Pattern
from drape.viewer.source import Source

FOV = 35.0  # degrees of the picture's height
SOME = 8  # frames that are looked at
FAR = 2.0  # sizes of the cloths: larger obstacles do not move the camera away
AWAY = np.array([0.5, 0.35, 1.0])  # from where the camera looks
BESIDE = 0.15  # sizes of the cloths, between bodies and the panels that lie flat


def display(linear: Sequence[float] | NDArray[Any]) -> tuple[int, int, int]:
    """A linear colour as the 8 bits of a screen."""
    a = np.array(linear)
    s = np.where(a <= 0.0031308, 12.92 * a, 1.055 * a ** (1 / 2.4) - 0.055)
    r, g, b = (int(c) for c in np.round(255 * s))
    return r, g, b


class Stage:
    """Frames the bodies of a source, and puts them on a ground.

    Attributes:
        size: of the cloths, m, by which things get their size
        eye, target: of the camera that sees all, m
        pattern: where panels of garments lie flat, by their numbers, [vertices, 3] m
    """

    def __init__(self, server: viser.ViserServer, source: Source) -> None:
        """Sets camera, light, ground and axes."""
        self._measure(source)
        self.pattern = self._lay(source.pattern) if source.pattern else {}
        start, self._camera = server.initial_camera, source.camera or {}
        self._fov = np.radians(float(self._camera.get("fov", FOV)))
        self.frame(bool(self.pattern))
        start.fov = self._fov
        start.position, start.look_at = tuple(self.eye), tuple(self.target)
        scene = server.scene
        scene.set_up_direction("+y")
        # with more of it colours are paler than they are, and folds flat
        scene.configure_environment_map("studio", environment_intensity=0.13)
        self._ground(scene)
        self._axes(scene)

    def _measure(self, source: Source) -> None:
        """Finds the boxes of cloths, and of all that the camera should see, in some of
        the frames that are there."""
        frames = list(source.frames())
        some = frames[:: max(len(frames) // SOME, 1)]
        boxes = []
        for body in source.bodies:
            parts = [source.positions(body, each) for each in some]
            x = np.concatenate(parts).astype(np.float64)
            boxes.append((body.kind == "cloth", np.stack([x.min(0), x.max(0)])))
        cloths = [box for cloth, box in boxes if cloth] or [box for _, box in boxes]
        self.size = max(float(np.linalg.norm(box[1] - box[0])) for box in cloths)
        near = [
            box
            for cloth, box in boxes
            if cloth or np.linalg.norm(box[1] - box[0]) <= FAR * self.size
        ]
        self._low = np.min([box[0] for box in near], axis=0)
        self._high = np.max([box[1] for box in near], axis=0)
        self._all = float(np.linalg.norm(self._high - self._low))
        self._floor = float(min(box[0][1] for _, box in boxes))
        if source.growing() and self._floor >= min(box[0][1] for box in cloths):
            # nothing is below the cloths: they will hang there, or fall
            self._floor -= self.size
            self._low[1] = self._floor
            self._all = float(np.linalg.norm(self._high - self._low))
        # what ends at the floor, as a box, is not to be in its plane
        self._sunk = 1e-3 * self._all

    def _lay(self, pattern: Pattern) -> dict[int, NDArray[Any]]:
        """Lays the panels of garments flat and upright, to the right of the bodies."""
        flat = pattern.lay(float(self._high[1] - self._low[1]))
        high = float(max(x[:, 1].max() for x in flat.values()))
        middle = (self._low + self._high) / 2
        left = float(self._high[0]) + BESIDE * self.size
        low = max(float(middle[1]) - high / 2, self._floor)
        corner = np.array([left, low, middle[2]])
        return {k: np.pad(x, ((0, 0), (0, 1))) + corner for k, x in flat.items()}

    def frame(self, pattern: bool) -> None:
        """Sets the camera that sees all, with or without the panels that lie flat:
        without it is the scene's own, where it has one."""
        eye, target = self._camera.get("eye"), self._camera.get("target")
        # a report's camera of which both are one place is one that sees all
        if not pattern and eye and target and list(eye) != list(target):
            self.eye, self.target = np.array(eye), np.array(target)
            return
        low, high = self._low, self._high
        if pattern:
            flat = np.concatenate(list(self.pattern.values()))
            low, high = np.minimum(low, flat.min(0)), np.maximum(high, flat.max(0))
        far = 0.5 * float(np.linalg.norm(high - low)) / np.sin(self._fov / 2)
        self.target = (low + high) / 2
        self.eye = self.target + AWAY / np.linalg.norm(AWAY) * far

    def is_floor(self, x: NDArray[Any]) -> bool:
        """Whether positions are level, and as low as anything."""
        return float(np.abs(x[:, 1] - self._floor).max()) <= 1e-6 * self._all

    def _ground(self, scene: viser.SceneApi) -> None:
        """A grid below all bodies, whose cells are a round length, with shadows."""
        cell = 10.0 ** np.floor(np.log10(max(self._all, 1e-6) / 4))
        self.cell = float(cell)
        scene.add_grid(
            "/ground",
            plane="xz",
            infinite_grid=True,
            cell_size=self.cell,
            section_size=10 * self.cell,
            cell_color=(205, 208, 212),
            section_color=(160, 165, 172),
            fade_distance=14 * self._all,
            shadow_opacity=0.35,
            plane_color=(238, 240, 243),
            plane_opacity=1.0,
            position=(0.0, self._floor - self._sunk, 0.0),
        )

    def _axes(self, scene: viser.SceneApi) -> None:
        """Three axes with their names at a corner of the ground."""
        long = 0.08 * self._all
        corner = (float(self._low[0]), self._floor, float(self._high[2]))
        scene.add_frame(
            "/axes",
            axes_length=long,
            axes_radius=0.03 * long,
            origin_radius=0.05 * long,
            position=corner,
        )
        for name, at in zip("xyz", np.eye(3) * 1.15 * long, strict=True):
            scene.add_label(f"/axes/{name}", name, position=tuple(at))

    def look(self, server: viser.ViserServer) -> None:
        """Brings the cameras of all who look back to where they see all."""
        for client in server.get_clients().values():
            with client.atomic():
                client.camera.position = self.eye
                client.camera.look_at = self.target
                client.camera.up_direction = np.array([0.0, 1.0, 0.0])


def bar(title: str, colours: NDArray[Any], words: Sequence[str]) -> str:
    """Returns HTML of a bar of linear colours with words below it, evenly spread."""
    stops = ", ".join(f"rgb{display(rgb)}" for rgb in colours)
    below = "".join(f"<span>{word}</span>" for word in words)
    return (
        '<div style="padding: 0.2em 0.75em 0.6em; font-size: 0.8em">'
        f'<div style="padding-bottom: 0.3em">{title}</div>'
        '<div style="height: 0.8em; border-radius: 0.2em; '
        f'background: linear-gradient(90deg, {stops})"></div>'
        '<div style="display: flex; justify-content: space-between">'
        f"{below}</div></div>"
    )
