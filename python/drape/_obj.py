# SPDX-License-Identifier: Apache-2.0
"""OBJ files as text: what a mesh's vertices are is replaced, and all else is kept.

Readers of meshes split or join vertices where texture coordinates are cut, and that is
what says where a garment's seams are. So the text itself is read here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _whole
from .errors import SceneError

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

MOST = 1 << 31  # of what a file has of a kind

FAR = 1e9  # a number of a file, whose squares and products are finite


@dataclass(frozen=True, eq=False)
class Obj:
    """What an OBJ file has; lengths are those of the file.

    Attributes:
        file: its name, for messages
        lines: its text
        x: [n, 3] vertices; at: [n] the lines that they are in
        uv: [k, 2] texture coordinates
        start: [faces + 1] the first corner of each face
        vertex, texture, normal: [corners] their numbers; -1: the file gives none
        face_at: [faces] the lines that they are in
        names: [faces] of the group, or of the object, that they are in
        groups: [corners] of equal numbers are the corners of a vertex to which the
            file gives the same normal
    """

    file: str
    lines: list[str]
    x: Floats
    at: Whole
    uv: Floats
    start: Whole
    vertex: Whole
    texture: Whole
    normal: Whole
    face_at: Whole
    names: list[str]
    groups: Whole

    @property
    def face_of(self) -> Whole:
        """[corners] the face that a corner is of."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def read(path: Path) -> Obj:
    """Reads a file; a SceneError that names the line where it is no OBJ."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from error
    return _Reader(str(path), data.decode("utf-8", "surrogateescape")).read()


class _Reader:
    """Reads a text line by line."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        # a line that ends in \ goes on
        self.lines = text.replace("\\\r\n", " ").replace("\\\n", " ").splitlines()
        self.points: dict[str, list[tuple[float, ...]]] = {"v": [], "vt": [], "vn": []}
        self.at: list[int] = []
        self.corners: list[tuple[int, int, int]] = []
        self.start = [0]
        self.face_at: list[int] = []
        self.names: list[str] = []
        self.group = self.object = ""

    def refuse(self, line: int, why: str) -> SceneError:
        return SceneError(f"{self.file}: line {line + 1}: {why}")

    def read(self) -> Obj:
        for k, line in enumerate(self.lines):
            words = line.split()
            if not words:
                continue
            key = words[0]
            if key in self.points:
                self.point(k, key, words[1:])
            elif key == "f":
                self.face(k, words[1:])
            elif key == "g":
                self.group = " ".join(words[1:])
            elif key == "o":
                self.object, self.group = " ".join(words[1:]), ""
        return self.made()

    def point(self, k: int, key: str, words: list[str]) -> None:
        count = 2 if key == "vt" else 3
        try:
            found = tuple(float(word) for word in words[:count])
        except ValueError:
            found = ()
        if len(found) < count or not all(abs(each) <= FAR for each in found):
            raise self.refuse(k, f"expected {key} and {count} numbers within ±{FAR:g}")
        if key == "v":
            self.at.append(k)
        self.points[key].append(found)

    def face(self, k: int, words: list[str]) -> None:
        number = len(self.face_at) + 1
        if len(words) < 3:
            raise self.refuse(k, f"face {number}: expected at least 3 corners")
        kinds = ("v", "vt", "vn")
        for word in words:
            parts = [*word.split("/"), "", ""][:3]
            corner = []
            for key, part in zip(kinds, parts, strict=True):
                have = len(self.points[key])
                try:
                    index = int(part) if part else 0
                except ValueError:
                    raise self.refuse(
                        k, f"face {number}: {word}: expected whole numbers"
                    ) from None
                # below 0 it counts from the last one so far; above, a file may
                # have it later
                corner.append(have + index if index < 0 else index - 1)
                no = index == 0 if part else False
                if no or index > MOST or (index < 0 and corner[-1] < 0):
                    raise self.refuse(
                        k, f"face {number}: {word}: there is no {key} {index}"
                    )
            if corner[0] < 0:
                raise self.refuse(k, f"face {number}: {word}: expected a vertex")
            self.corners.append((corner[0], corner[1], corner[2]))
        self.start.append(len(self.corners))
        self.face_at.append(k)
        self.names.append(self.group or self.object)

    def made(self) -> Obj:
        if not self.face_at:
            raise SceneError(f"{self.file}: there is no face in it: is it an OBJ file?")
        corners = np.array(self.corners, np.int64).reshape(-1, 3)
        start = np.array(self.start, np.int64)
        for column, key in enumerate(("v", "vt", "vn")):
            beyond = np.flatnonzero(corners[:, column] >= len(self.points[key]))
            if len(beyond):
                face = int(np.searchsorted(start, beyond[0], "right")) - 1
                raise self.refuse(
                    self.face_at[face],
                    f"face {face + 1}: there is no {key} "
                    f"{corners[beyond[0], column] + 1}; the file has "
                    f"{len(self.points[key])}",
                )
        vertex, texture, normal = corners.T
        n = np.array(self.points["vn"] or [(0.0, 0.0, 0.0)], np.float64)
        alike = np.unique(n, axis=0, return_inverse=True)[1].reshape(-1)
        rows = np.column_stack([vertex, np.where(normal < 0, -1, alike[normal])])
        groups = np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1)
        return Obj(
            file=self.file,
            lines=self.lines,
            x=np.array(self.points["v"], np.float64).reshape(-1, 3),
            at=np.array(self.at, np.int64),
            uv=np.array(self.points["vt"], np.float64).reshape(-1, 2),
            start=start,
            vertex=vertex,
            texture=texture,
            normal=normal,
            face_at=np.array(self.face_at, np.int64),
            names=self.names,
            groups=groups,
        )


def write(path: Path, obj: Obj, x: NDArray[Any]) -> None:
    """Writes the file anew with its vertices at x, [n, 3] in its own unit. Where it
    has normals, they are those of the new shape, smooth where they were."""
    lines: list[str | None] = list(obj.lines)
    for place, at in zip(x.tolist(), obj.at.tolist(), strict=True):
        rest = obj.lines[at].split()[4:]  # a weight, or a colour
        lines[at] = " ".join(["v", *(f"{each:.9g}" for each in place), *rest])
    if (obj.normal >= 0).any():
        _put_normals(lines, obj, x)
    text = "\n".join(each for each in lines if each is not None) + "\n"
    _whole.write(path, text.encode("utf-8", "surrogateescape"))


def _put_normals(lines: list[str | None], obj: Obj, x: NDArray[Any]) -> None:
    """Puts new normals in place of the first, and their numbers into the faces."""
    normals = group_normals(obj, x)
    rows = "\n".join(f"vn {a:.6f} {b:.6f} {c:.6f}" for a, b, c in normals.tolist())
    for k, line in enumerate(obj.lines):
        if line.split(maxsplit=1)[:1] == ["vn"]:
            lines[k] = rows or None
            rows = ""
    for face, at in enumerate(obj.face_at.tolist()):
        words = []
        for c in range(obj.start[face], obj.start[face + 1]):
            texture = obj.texture[c] + 1 if obj.texture[c] >= 0 else ""
            if obj.normal[c] >= 0:
                words.append(f"{obj.vertex[c] + 1}/{texture}/{obj.groups[c] + 1}")
            else:
                words.append(f"{obj.vertex[c] + 1}/{texture}".rstrip("/"))
        lines[at] = "f " + " ".join(words)


def group_normals(obj: Obj, x: NDArray[Any]) -> Floats:
    """Returns a unit normal for each of the file's groups of corners: the mean of
    those of its faces, by their areas."""
    face = obj.face_of
    p = x[obj.vertex]
    following = np.arange(len(p)) + 1
    following[obj.start[1:] - 1] = obj.start[:-1]
    # Newell's: twice the area of a polygon, by its normal
    area = np.add.reduceat(np.cross(p, p[following]), obj.start[:-1])
    total = np.zeros((int(obj.groups.max()) + 1, 3))
    for i in range(3):
        total[:, i] = np.bincount(obj.groups, area[face, i], len(total))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    unit: Floats = np.divide(total, length, out=np.zeros_like(total), where=length > 0)
    return unit
