# SPDX-License-Identifier: Apache-2.0
"""The panels of garments as they are cut, flat, and the seams that join them."""

from __future__ import annotations

import html
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drape._core import ffi
from drape.export import mesh
from drape.export.run import Body, Run

if TYPE_CHECKING:
    from drape.world import World

Array = NDArray[Any]
GAP = 0.12  # between panels that lie beside each other, by the mean of their sides
HELD = (25, 25, 25)  # sRGB of attachments
GROUND = (238, 240, 243)  # of the stage
COLOURS = 48  # of seams, before they come again
CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
OPPONENTS = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


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
class Attachment:
    """A border that `drape sew` holds once the garment is worn."""

    name: str
    body: int
    """The panel, by its number among the bodies."""
    edges: NDArray[np.int64]
    """[edges, 2] vertices of the panel that are held."""
    end: str = ""
    """When it held, where it was sewn."""


@dataclass(frozen=True, eq=False)
class Pattern:
    """The panels of a scene's garments, their seams and attachments."""

    rest: dict[int, NDArray[np.float64]]
    """Of each panel, by its number among the bodies: its vertices, [vertices, 2] m."""
    seams: Sequence[Seam]
    attachments: Sequence[Attachment] = ()

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
        """The lines of all seams and attachments, [lines, 2, 3] m, and their colours,
        likewise.

        Args:
            at: returns where the vertices of a panel are, [vertices, 3] m
        """
        points, colours = [np.zeros((0, 2, 3))], [np.zeros((0, 2, 3), np.uint8)]
        for seam in self.seams:
            for side in seam.sides:
                lines = side.lines(at(side.body))
                points.append(lines)
                colours.append(np.full(lines.shape, seam.colour, np.uint8))
        for each in self.attachments:
            points.append(at(each.body)[each.edges])
            colours.append(np.full(points[-1].shape, HELD, np.uint8))
        return np.concatenate(points), np.concatenate(colours)

    def legend(self) -> str:
        """HTML of the colours, names and ends of seams and attachments."""
        each = [(seam.colour, seam.name, seam.end) for seam in self.seams]
        each += [(HELD, row.name, row.end) for row in self.attachments]
        rows = "".join(
            f'<div><span style="color: rgb{colour}">&#9632;</span> {html.escape(name)}'
            + (f", {html.escape(end)}" if end else "")
            + "</div>"
            for colour, name, end in each
        )
        return f'<div style="padding: 0.2em 0.75em; font-size: 0.8em">{rows}</div>'


def perceived(rgb: Array) -> Array:
    """[n, 3] sRGB colours, 0 to 255, in OKLab (B. Ottosson 2020), in which distances
    are about as large as they look."""
    linear = mesh.linear(np.asarray(rgb, np.float64) / 255)
    lab: Array = np.cbrt(linear @ CONES.T) @ OPPONENTS.T
    return lab


@cache
def _palette() -> list[tuple[int, int, int]]:
    """Colours of which each is as far as can be from the ones before, the ground's
    and that of attachments; none is pale, dark or grey."""
    some = np.stack(np.meshgrid(*3 * [np.arange(0, 256, 15)], indexing="ij"), -1)
    rgb = some.reshape(-1, 3)
    lab = perceived(rgb)
    strong = np.hypot(lab[:, 1], lab[:, 2]) > 0.1
    good = strong & (lab[:, 0] > 0.35) & (lab[:, 0] < 0.87)
    rgb, lab = rgb[good], lab[good]
    taken = perceived(np.array([GROUND, HELD]))
    far = np.linalg.norm(lab[:, None] - taken, axis=2).min(1)
    found = []
    for _ in range(COLOURS):
        k = int(far.argmax())
        r, g, b = rgb[k].tolist()
        found.append((r, g, b))
        far = np.minimum(far, np.linalg.norm(lab - lab[k], axis=1))
    return found


def colour_of(number: int) -> tuple[int, int, int]:
    """The colour of a seam; the first ones differ most."""
    return _palette()[number % COLOURS]


def _edges(faces: Array, who: Array) -> Array:
    """[edges, 2] edges of triangles whose two ends are among some vertices."""
    held = np.isin(faces, who)
    ends = [faces[held[:, k] & held[:, k - 1]][:, [k - 1, k]] for k in range(3)]
    return np.unique(np.sort(np.concatenate(ends)), axis=0)


def make(
    bodies: Sequence[Body],
    panels: Sequence[int],
    seams: Sequence[dict[str, Any]],
    attachments: Sequence[dict[str, Any]] = (),
    sewn: dict[str, Any] | None = None,
) -> Pattern | None:
    """The pattern of bodies of which some are panels; None: nothing joins these.

    Args:
        bodies: cloths are the first of them
        panels: the numbers of panels among the bodies
        seams: as seams.json has them
        attachments: likewise
        sewn: a sew.json, which tells how seams and attachments ended
    """
    grids = [body.grid or (0, 0) for body in bodies]
    first = np.cumsum([0, *(m * n for m, n in grids)])
    rest = {k: x for k in panels if (x := bodies[k].rest) is not None}

    def vertices(k: int, particles: Any) -> Array:
        found: Array = np.searchsorted(bodies[k].rows, first[k] + np.array(particles))
        return found

    found: list[Seam] = []
    for k, seam in enumerate(seams):
        (a, b), part = seam["cloths"], np.array(seam["part"], np.float64)
        if a not in rest or b not in rest:
            continue  # what holds an edge is no seam of the pattern
        one = vertices(a, seam["particles"])
        two = vertices(b, seam["onto"]).reshape(-1, 2)
        sides = Side(a, np.stack([one, one], 1), 0 * part), Side(b, two, part)
        end = _end(sewn["seams"][k]) if sewn else ""
        found.append(Seam(str(seam["name"]), sides, colour_of(len(found)), end))
    held = []
    for k, row in enumerate(attachments):
        body = row["cloth"]
        who = vertices(body, row["particles"])
        end = _held(sewn["attachments"][k]) if sewn else ""
        edges = _edges(bodies[body].faces, who)
        held.append(Attachment(str(row["name"]), body, edges, end))
    return Pattern(rest, found, held) if found else None


def pattern_of(world: World, bodies: Sequence[Body]) -> Pattern | None:
    """The pattern of a world's garments; None: it has none that is sewn."""
    definition = world._open().definition
    cloths = definition.cloths[0 : definition.n_cloths]
    seams = []
    for seam in definition.seams[0 : definition.n_seams]:
        (a, b), n = seam.cloth, seam.n
        row = {
            "name": f"{bodies[a].name} to {bodies[b].name}",
            "cloths": (a, b),
            "particles": np.frombuffer(ffi.buffer(seam.particle, 4 * n), np.int32),
            "onto": np.frombuffer(ffi.buffer(seam.onto, 8 * n), np.int32),
            "part": np.frombuffer(ffi.buffer(seam.part, 8 * n)),
        }
        seams.append(row)
    return make(bodies, [k for k, each in enumerate(cloths) if each.panel], seams)


def _end(row: dict[str, Any]) -> str:
    """How a seam of sew.json ended."""
    if row["closed"] is None:
        return f"open by {1000 * float(row['gap_m']):.2g} mm"
    return f"closed in step {row['closed']}"


def _held(row: dict[str, Any]) -> str:
    """How an attachment of sew.json ended."""
    if row["from"] is None:
        return "not yet held"
    if row["until"] is None:
        return f"held from step {row['from']}"
    return f"held in steps {row['from']} to {row['until']}"


def pattern_of_run(run: Run) -> Pattern | None:
    """The pattern of a run's garments, by what `drape run` and `drape sew` write of
    them; None: it has none that is sewn."""
    try:
        text = (run.folder / "seams.json").read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    about = json.loads(text)
    file = run.folder / "sew.json"  # which is written at the end
    sewn = json.loads(file.read_text(encoding="utf-8")) if file.exists() else None
    return make(run.bodies, about["panels"], about["seams"], about["attachments"], sewn)
