# SPDX-License-Identifier: Apache-2.0
"""Reads the folder that `drape run` writes: its report, bodies and frames.

A frame's file holds all cloths of a run, or all its obstacles. A `Run` gives
them body by body, by the names of the scene, without the particles that holes
and cuts have left without a cell.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drape._meshes import are_of
from drape.errors import SceneError
from drape.export.contacts import FrameContacts, read_contacts

Positions = NDArray[np.floating[Any]]

_FRAME = re.compile(r"cloth_(\d{4,})\.ply")
_HEADER = re.compile(
    rb"ply\nformat binary_little_endian 1\.0\n(?:comment [^\n]*\n)*"
    rb"element vertex (\d+)\nproperty (float|double) x\nproperty \2 y\n"
    rb"property \2 z\nelement face (\d+)\n"
    rb"property list uchar int vertex_indices\nend_header\n"
)
_FACE = np.dtype([("count", "u1"), ("vertices", "<i4", 3)])


class RunError(SceneError):
    """A folder that no run has left. The text is one line, and names the file."""


@dataclass(frozen=True, eq=False)
class Body:
    """A cloth or an obstacle of a run."""

    name: str
    kind: str
    """`cloth` or `obstacle`."""
    rows: NDArray[np.int64]
    """[vertices] the rows of a frame's file that hold the body's vertices."""
    faces: NDArray[np.int32]
    """[triangles, 3] vertices of the body, from 0."""
    uv: NDArray[np.float32] | None
    """[vertices, 2] places on the cloth at rest, 0 to 1 along each edge of its grid."""
    rest: NDArray[np.float64] | None
    """The same in m."""
    grid: tuple[int, int] | None
    """Particles of a cloth along u and v."""
    size: tuple[float, float] | None
    """Size of a cloth at rest along u and v, m."""
    moving: bool
    """Whether the frames differ."""
    colour: tuple[float, float, float] | None = None
    """sRGB, 0 to 1; None where the scene gives none."""


def numbered(path: Path) -> None:
    """Refuses the name of a file a frame that has no place for the number."""
    if not re.fullmatch(r"[^%]*%0?\d*d[^%]*", path.name):
        raise RunError(
            f"{path}: a file {path.suffix} holds one frame: expected a name with a "
            f"place for its number, as frame_%04d{path.suffix}"
        )


def make_body(name: str, tri: NDArray[np.int32], moving: bool) -> Body:
    """An obstacle of these triangles, whose vertices are rows of a frame."""
    rows, flat = np.unique(tri, return_inverse=True)
    faces = flat.reshape(-1, 3).astype(np.int32)
    return Body(
        name, "obstacle", rows.astype(np.int64), faces, None, None, None, None, moving
    )


def make_cloth(
    name: str,
    tri: NDArray[np.int32],
    first: int,
    grid: tuple[int, int],
    size: tuple[float, float],
    rest: NDArray[np.float64] | None = None,
) -> Body:
    """A cloth of these triangles, whose particle 0 is row `first` of a frame.

    Args:
        rest: [particles, 2] m, where they are at rest; None: where the grid has them
    """
    body = make_body(name, tri, True)
    who = body.rows - first
    m, n = grid
    if rest is None:
        uv = np.stack([who % m / (m - 1), who // m / (n - 1)], 1)
        rest = uv * size
    else:
        rest = rest[who]
        uv = rest / size
    made = replace(body, kind="cloth", uv=uv.astype(np.float32), rest=rest)
    return replace(made, grid=grid, size=size)


def read_ply(path: Path) -> tuple[Positions, NDArray[np.int32]]:
    """Returns the vertices [n, 3], m, and the triangles [n, 3] of a frame.

    The numbers are those of the file, of 32 or 64 bits.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RunError(f"{path}: cannot be read: {error.strerror}") from None
    head = _HEADER.match(data)
    if not head:
        raise RunError(f"{path}: expected a frame as `drape run` writes it")
    number = np.dtype("<f4" if head[2] == b"float" else "<f8")
    vertices, triangles = int(head[1]), int(head[3])
    middle = head.end() + 3 * vertices * number.itemsize
    if len(data) != middle + triangles * _FACE.itemsize:
        raise RunError(f"{path}: its length is not that of its header")
    x = np.frombuffer(data, number, 3 * vertices, head.end()).reshape(-1, 3)
    face = np.frombuffer(data, _FACE, triangles, middle)
    tri = np.ascontiguousarray(face["vertices"])
    if (face["count"] != 3).any() or not are_of(tri, vertices):
        raise RunError(f"{path}: expected triangles of its own vertices")
    return x, tri


class Run:
    """A run's folder.

    Raises RunError where the folder is not a run's.
    """

    def __init__(self, folder: str | Path) -> None:
        """Reads the report and the first frame."""
        self.folder = Path(folder)
        path = self.folder / "report.json"
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise RunError(
                f"{path}: cannot be read: {error.strerror} (is this what "
                "`drape run` wrote?)"
            ) from None
        try:
            self.report: dict[str, Any] = json.loads(text)
            self._read_head()
            self._read_bodies(self.report["bodies"])
        except (KeyError, TypeError, ValueError, IndexError) as error:
            if isinstance(error, RunError):
                raise
            raise RunError(f"{path}: expected a run's report ({error!r})") from None

    def __repr__(self) -> str:
        """The run in one line."""
        return (
            f"<drape.export.Run {self.scene!r}: {len(self.frames())} frames, "
            f"{len(self.bodies)} bodies, {self.end}>"
        )

    def _read_head(self) -> None:
        report = self.report
        self.scene = str(report["scene"])
        """The scene's name."""
        self.end = str(report["end"])
        """`complete`, or how the run ended, or `unfinished`."""
        self.precision = int(report["precision"])
        """Bits of a number in the frames."""
        self.seconds = float(report["dt"]) * int(report["steps_per_frame"])
        """Time between two frames, s."""
        if not 0 < self.seconds < 1e9:
            raise ValueError("dt")
        rate = 1 / self.seconds
        self.fps = round(rate) if abs(rate - round(rate)) < 1e-9 * rate else rate
        """Frames a second; a whole number where it is one but for rounding."""

    def _read_bodies(self, list_: list[dict[str, Any]]) -> None:
        frames = self.frames()
        if not frames:
            raise RunError(f"{self.folder}: no frames/cloth_0000.ply here")
        self._first = frames[0]
        still = self.folder / "obstacles.ply"
        self.moving = not still.exists()
        """Whether some obstacle moves, so that each frame has its own file."""
        x, tri = read_ply(self._path("cloth", frames[0]))
        self._vertices = {"cloth": len(x), "obstacle": 0}
        # the bodies of one frame share its file
        self._all = lru_cache(maxsize=4)(self._load)
        self._rest: Positions | None = None  # a run of panels has them
        path = self.folder / "rest.ply"
        if path.exists():
            self._rest, _ = read_ply(path)
            if len(self._rest) != len(x):
                raise RunError(f"{path}: of another run than report.json's")
        first = [int(b["first_vertex"]) for b in list_]
        cloths = sum(b["kind"] == "cloth" for b in list_)
        first.append(int(self.report["vertices"]))
        face = [int(b["first_triangle"]) for b in list_]
        face.append(int(self.report["triangles"]))
        if first[cloths] != len(x) or face[cloths] != len(tri):
            raise RunError(
                f"{self._path('cloth', frames[0])}: a frame of another run "
                "than report.json's"
            )
        self.bodies: list[Body] = []
        """Cloths first, in the scene's order."""
        shift = 0, 0
        for k, body in enumerate(list_):
            if k == cloths:
                shift = first[k], face[k]
                x, tri = read_ply(self._path("obstacle", frames[0]))
                self._vertices["obstacle"] = len(x)
            mine = tri[face[k] - shift[1] : face[k + 1] - shift[1]]
            self.bodies.append(self._make(body, mine, first[k] - shift[0]))

    def _make(self, body: dict[str, Any], tri: NDArray[np.int32], first: int) -> Body:
        name, look = str(body["name"]), body.get("look") or {}
        r, g, b = look.get("colour") or (None, 0, 0)
        colour = None if r is None else (float(r), float(g), float(b))
        if body["kind"] != "cloth":
            moving = bool(body.get("moving", self.moving))
            return replace(make_body(name, tri, moving), colour=colour)
        m, n = (int(k) for k in body["particles"])
        width, height = (float(k) for k in body["size"])
        rest = None
        if self._rest is not None:
            rest = self._rest[first : first + m * n, :2].astype(np.float64)
        made = make_cloth(name, tri, first, (m, n), (width, height), rest)
        return replace(made, colour=colour)

    def _path(self, kind: str, frame: int) -> Path:
        if kind == "cloth":
            return self.folder / "frames" / f"cloth_{frame:04d}.ply"
        if self.moving:
            return self.folder / "frames" / f"obstacles_{frame:04d}.ply"
        return self.folder / "obstacles.ply"

    def frames(self) -> list[int]:
        """The numbers of the frames that are there now, ascending.

        A run that goes on adds frames; each is complete when it appears.
        """
        try:
            names = [p.name for p in (self.folder / "frames").iterdir()]
        except OSError:
            return []
        return sorted(int(m[1]) for m in map(_FRAME.fullmatch, names) if m)

    def _load(self, kind: str, frame: int) -> Positions:
        path = self._path(kind, frame)
        x, _ = read_ply(path)
        if len(x) != self._vertices[kind]:
            raise RunError(f"{path}: a frame of another run than report.json's")
        return x

    def particles(self, frame: int) -> Positions:
        """All particles of all cloths in a frame, [particles, 3] m, those among them
        that no cell has."""
        return self._all("cloth", frame)

    def positions(self, body: Body, frame: int) -> Positions:
        """The vertices of a body in a frame, [vertices, 3] m, of `precision` bits."""
        return self._all(body.kind, frame if body.moving else self._first)[body.rows]

    def contacts(self, frame: int) -> FrameContacts | None:
        """What touched in a frame's last step; None where the run has not written
        contacts (`drape run --contacts`)."""
        path = self.folder / "frames" / f"contacts_{frame:04d}.ply"
        try:
            return read_contacts(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise RunError(str(error)) from None
