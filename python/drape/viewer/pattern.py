# SPDX-License-Identifier: Apache-2.0
"""The panels of garments as they are cut, flat, and the seams that join them."""

from __future__ import annotations

import colorsys
import html
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drape import scene as scenes
from drape._core import ffi
from drape._define import read_scene, with_keys
from drape.errors import SceneError
from drape.export.run import Body

Array = NDArray[Any]
GAP = 0.12  # between panels that lie beside each other, by the mean of their sides
TURN = 0.61803  # of the hues of one seam and the next: the golden section


@dataclass(frozen=True, eq=False)
class Side:
    """The places of a seam on one of the edges that it joins."""

    body: int
    """The panel, by its number among the bodies."""
    ends: NDArray[np.int64]
    """[points, 2] vertices of the panel."""
    part: NDArray[np.float64]
    """[points] a place is (1 - part) of the first vertex and part of the second."""

    def lines(self, x: Array) -> Array:
        """The lines from place to place, [lines, 2, 3] m, with the panel at x."""
        part = self.part[:, None]
        place = (1 - part) * x[self.ends[:, 0]] + part * x[self.ends[:, 1]]
        return np.stack([place[:-1], place[1:]], 1)


@dataclass(frozen=True, eq=False)
class Seam:
    """A seam, and its colour."""

    name: str
    sides: tuple[Side, Side]
    colour: tuple[int, int, int]
    """sRGB."""
    end: str = ""
    """How it ended, where it was sewn."""


@dataclass(frozen=True, eq=False)
class Pattern:
    """The panels of a scene's garments, and their seams."""

    rest: dict[int, NDArray[np.float64]]
    """Of each panel, by its number among the bodies: its vertices, [vertices, 2] m."""
    seams: Sequence[Seam]

    def with_rest(self, bodies: Sequence[Body]) -> list[Body]:
        """The bodies, of which panels know their vertices' places at rest: those at
        an outline are not where the grid has them."""
        made = list(bodies)
        for k, x in self.rest.items():
            uv = (x / np.array(made[k].size)).astype(np.float32)
            made[k] = replace(made[k], uv=uv, rest=x)
        return made

    def lay(self, room: float) -> dict[int, Array]:
        """Lays the panels flat in rows that are about as high together as `room`, m.
        Returns the vertices of each, [vertices, 2] m; their least is 0."""
        box = {k: (x.min(0), np.ptp(x, axis=0)) for k, x in self.rest.items()}
        sides = np.array([size for _, size in box.values()])
        gap = GAP * float(sides.mean())
        area = float((sides + gap).prod(1).sum())
        wide = max(float(sides[:, 0].max()), area / room)
        found: dict[int, Array] = {}
        at = np.zeros(2)
        high = 0.0
        for k, (low, size) in box.items():
            if at[0] > 0 and at[0] + size[0] > wide + gap:
                at, high = np.array([0.0, at[1] - high - gap]), 0.0
            # rows are filled from the top: a panel hangs from the row's upper edge
            found[k] = self.rest[k] - low + at - [0.0, size[1]]
            at[0] += size[0] + gap
            high = max(high, float(size[1]))
        low = np.min([x.min(0) for x in found.values()], axis=0)
        return {k: x - low for k, x in found.items()}

    def lines(self, at: Callable[[int], Array]) -> tuple[Array, Array]:
        """The lines of all seams, [lines, 2, 3] m, and their colours, likewise.

        Args:
            at: returns where the vertices of a panel are, [vertices, 3] m
        """
        points, colours = [np.zeros((0, 2, 3))], [np.zeros((0, 2, 3), np.uint8)]
        for seam in self.seams:
            for side in seam.sides:
                lines = side.lines(at(side.body))
                points.append(lines)
                colours.append(np.full(lines.shape, seam.colour, np.uint8))
        return np.concatenate(points), np.concatenate(colours)

    def legend(self) -> str:
        """HTML of the seams' colours, names and ends."""
        rows = "".join(
            f'<div><span style="color: rgb{seam.colour}">&#9632;</span> '
            f"{html.escape(seam.name)}"
            + (f", {html.escape(seam.end)}" if seam.end else "")
            + "</div>"
            for seam in self.seams
        )
        return f'<div style="padding: 0.2em 0.75em; font-size: 0.8em">{rows}</div>'


def colour_of(number: int) -> tuple[int, int, int]:
    """The colour of a seam: neighbours in the list differ, and few look alike."""
    light = (0.95, 0.7)[number // 8 % 2]
    r, g, b = colorsys.hsv_to_rgb(number * TURN % 1, 0.9, light)
    return round(255 * r), round(255 * g), round(255 * b)


def pattern_of(
    definition: Any, bodies: Sequence[Body], ends: Sequence[dict[str, Any]] = ()
) -> Pattern | None:
    """The panels among the cloths of a drape_def; None: it has no garment that is sewn.

    Args:
        definition: whose cloths are the first of the bodies, in this order
        bodies: of the run, or of the world
        ends: the seams of a sew.json, where they were sewn
    """
    first, rest = [0], {}
    for k in range(definition.n_cloths):
        cloth = definition.cloths[k]
        count = cloth.m * cloth.n
        first.append(first[-1] + count)
        if cloth.panel and k < len(bodies):
            x = np.frombuffer(ffi.buffer(cloth.panel.rest, 16 * count)).reshape(-1, 2)
            rest[k] = x[bodies[k].rows - first[k]].copy()

    def side(k: int, particles: Array, part: Array) -> Side:
        return Side(k, np.searchsorted(bodies[k].rows, first[k] + particles), part)

    seams: list[Seam] = []
    for k in range(definition.n_seams):
        seam, n = definition.seams[k], definition.seams[k].n
        a, b = seam.cloth[0], seam.cloth[1]
        if a not in rest or b not in rest:
            continue  # what holds an edge is no seam of the pattern
        one = np.frombuffer(ffi.buffer(seam.particle, 4 * n), np.int32)
        two = np.frombuffer(ffi.buffer(seam.onto, 8 * n), np.int32).reshape(-1, 2)
        part = np.frombuffer(ffi.buffer(seam.part, 8 * n)).copy()
        sides = side(a, np.stack([one, one], 1), 0 * part), side(b, two, part)
        name, end = f"{bodies[a].name} to {bodies[b].name}", ""
        if k < len(ends):
            name, end = str(ends[k]["name"]), _end(ends[k])
        seams.append(Seam(name, sides, colour_of(len(seams)), end))
    return Pattern(rest, seams) if seams else None


def _end(row: dict[str, Any]) -> str:
    """How a seam of sew.json ended."""
    if row["closed"] is None:
        return f"open by {1000 * float(row['gap_m']):.2g} mm"
    return f"closed in step {row['closed']}"


def sewn_pattern(folder: Path, bodies: Sequence[Body]) -> Pattern | None:
    """The pattern of a folder that `drape sew` has written; None: it is another one.

    Raises:
        SceneError: the pattern's file is not there any more, or is another one now
    """
    file = folder / "sewn.json"
    if not file.exists():
        return None
    # bodies can be large, and no panel needs them
    text = with_keys(scenes.read(file), {"obstacles": []})
    made = read_scene(text, notes=False)
    definition = getattr(made, "def")
    about = json.loads((folder / "sew.json").read_text(encoding="utf-8"))
    sizes = [(cloth.m, cloth.n) for cloth in definition.cloths[0 : definition.n_cloths]]
    if sizes != [body.grid for body in bodies if body.kind == "cloth"]:
        raise SceneError(f"{file}: its pattern is cut otherwise than this run's")
    return pattern_of(definition, bodies, about["seams"])
