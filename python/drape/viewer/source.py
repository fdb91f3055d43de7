# SPDX-License-Identifier: Apache-2.0
"""What a page shows: frames of bodies that were recorded, or that are being made."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from drape.errors import SceneError
from drape.export.run import Body, Positions, Run, make_body
from drape.meshes import Mesh
from drape.viewer.pattern import Pattern, pattern_of_run


@dataclass(frozen=True, eq=False)
class Contacts:
    """Where bodies touch in a frame, and how they push each other."""

    points: NDArray[np.float32]
    """[contacts, 3] m."""
    forces: NDArray[np.float32]
    """[contacts, 3] N, on the cloth, the mean of a step's last slice."""


def on_cloths(
    bodies: NDArray[np.int32], impulses: NDArray[np.float64], cloths: int
) -> NDArray[np.float64]:
    """Impulses that side A got, as those that cloth got, which is side B where A
    is of an obstacle."""
    return np.where(bodies[:, :1] < cloths, 1, -1) * impulses


class Source(Protocol):
    """A run that a page shows. Frames are numbered in ascending order."""

    title: str
    bodies: Sequence[Body]
    seconds: float
    """Time between frame k and frame k + 1, s."""
    camera: dict[str, Any] | None
    """The scene's camera: `eye` and `target`, m, and `fov`, degrees."""
    no_contacts: str
    """Why there are no contacts, where there are none."""
    pattern: Pattern | None
    """Of garments that are sewn; None: there are none."""

    def frames(self) -> Sequence[int]:
        """The numbers of the frames that can be shown now."""

    def growing(self) -> bool:
        """Whether there may be more frames later."""

    def want(self, frame: int) -> None:
        """Says that frames up to this one are wanted next."""

    def positions(self, body: Body, frame: int) -> Positions:
        """The vertices of a body, [vertices, 3] m."""

    def contacts(self, frame: int) -> Contacts | None:
        """The contacts of a frame; None where nobody knows them."""

    def words(self, frame: int) -> str:
        """What to say of a frame, in one line."""

    def close(self) -> None:
        """Ends what makes the frames."""


def step_words(outcome: str, contacts: int, rounds: int, iterations: int) -> str:
    """What a step's report says, in one line."""
    counts = {"contact": contacts, "round": rounds, "iteration": iterations}
    parts = (f"{n} {name}{'s' if n != 1 else ''}" for name, n in counts.items())
    return ", ".join([outcome, *parts])


class Recorded:
    """The frames of a run's folder; while the run goes on there come more."""

    no_contacts = "`drape run --contacts` writes contacts"

    def __init__(self, folder: str | Path) -> None:
        """Opens the folder of a run."""
        self.run = Run(folder)
        self.title = self.run.scene
        self.bodies: Sequence[Body] = self.run.bodies
        self.pattern = pattern_of_run(self.run)
        again = self.run.folder / "sewn.json"
        if again.exists():
            self.no_contacts = f"`drape sew` writes none, `drape view {again}` has them"
        self.seconds = self.run.seconds
        self.camera: dict[str, Any] | None = self.run.report.get("camera")
        self._steps: list[dict[str, Any]] = self.run.report["steps"]
        self._end = self.run.end

    def frames(self) -> Sequence[int]:
        """The numbers of the frames that are there."""
        return self.run.frames()

    def growing(self) -> bool:
        """Whether the report says that the run has not come to its end."""
        if self._end != "unfinished":
            return False
        path = self.run.folder / "report.json"
        report = json.loads(path.read_text(encoding="utf-8"))
        self._end, self._steps = str(report["end"]), report["steps"]
        return self._end == "unfinished"

    def want(self, frame: int) -> None:
        """Does nothing: the run is another process's."""

    def positions(self, body: Body, frame: int) -> Positions:
        """The vertices of a body, [vertices, 3] m."""
        return self.run.positions(body, frame)

    def contacts(self, frame: int) -> Contacts | None:
        """The contacts of a frame; None where the run was made without."""
        found = self.run.contacts(frame)
        if found is None:
            return None
        cloths = sum(body.kind == "cloth" for body in self.bodies)
        force = on_cloths(found.bodies, found.impulses, cloths) / (found.dt or 1)
        return Contacts(found.points.astype(np.float32), force.astype(np.float32))

    def words(self, frame: int) -> str:
        """The report of the frame's last step."""
        step = frame * int(self.run.report["steps_per_frame"]) - 1
        if not 0 <= step < len(self._steps):
            return ""
        keys = "outcome", "contacts", "rounds", "iterations"
        return step_words(*(self._steps[step][key] for key in keys))

    def close(self) -> None:
        """Does nothing: the run is another process's."""


class Meshes:
    """Meshes of any program, with the frames of those that move."""

    no_contacts = "meshes have no contacts"
    pattern: Pattern | None = None
    camera: dict[str, Any] | None = None

    def __init__(self, meshes: Sequence[Mesh], title: str) -> None:
        """Takes the meshes, of which those that move have equally many frames."""
        self.title = title
        moving = [each for each in meshes if each.frames is not None]
        self._x: dict[str, Positions] = {}
        self.bodies: Sequence[Body] = [self._add(k, m) for k, m in enumerate(meshes)]
        self.seconds = moving[0].frame_dt if moving else 1 / 60
        self._count = max(len(each) for each in self._x.values())
        for name, x in self._x.items():
            if len(x) not in (1, self._count):
                raise SceneError(f"{name}: {len(x)} frames; others have {self._count}")

    def _add(self, number: int, mesh: Mesh) -> Body:
        x = mesh.vertices[None] if mesh.frames is None else mesh.frames
        body = make_body(mesh.name or f"mesh {number}", mesh.triangles, len(x) > 1)
        name = body.name
        while name in self._x:
            name += "'"
        self._x[name] = np.asarray(x)[:, body.rows]
        kind = mesh.kind or "cloth"
        return replace(body, name=name, kind=kind)

    def frames(self) -> Sequence[int]:
        """The numbers of the frames."""
        return range(self._count)

    def growing(self) -> bool:
        """False: all frames are there."""
        return False

    def want(self, frame: int) -> None:
        """Does nothing: all frames are there."""

    def positions(self, body: Body, frame: int) -> Positions:
        """The vertices of a body, [vertices, 3] m."""
        x = self._x[body.name]
        found: Positions = x[min(frame, len(x) - 1)]
        return found

    def contacts(self, frame: int) -> Contacts | None:
        """None: nobody knows them."""
        return None

    def words(self, frame: int) -> str:
        """Nothing."""
        return ""

    def close(self) -> None:
        """Does nothing."""
