# SPDX-License-Identifier: Apache-2.0
"""Meshes with UV charts, as OBJ, for tests: tubes, cones and cushions."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Corner = tuple[int, int]  # a vertex, and a place in UV, from 0


@dataclass
class Charted:
    """What an OBJ file is written of: faces by the names of their charts."""

    x: list[Any] = field(default_factory=list)
    uv: list[Any] = field(default_factory=list)
    charts: dict[str, list[list[Corner]]] = field(default_factory=dict)

    def write(self, path: Path, unit: float = 1, normals: bool = False) -> Path:
        """Writes the mesh, whose vertices are in metres, in another unit."""
        lines = ["# for a test", "mtllib cloth.mtl"]
        lines += ["v " + " ".join(f"{c / unit:.9f}" for c in p) for p in self.x]
        lines += ["vt " + " ".join(f"{c:.9f}" for c in p) for p in self.uv]
        lines += ["vn 0 0 1"] if normals else []
        end = "/1" if normals else ""
        for name, faces in self.charts.items():
            lines += [f"g {name}", "usemtl cotton"]
            for face in faces:
                words = [f"{v + 1}/{t + 1}{end}" for v, t in face]
                lines.append("f " + " ".join(words))
        path.write_text("\n".join(lines) + "\n")
        return path

    def grid(self, name: str, vertex: Array, uv: Array) -> None:
        """Adds a chart of quads: the numbers of vertices [m, n] and their UVs
        [m, n, 2]; where a row is one vertex, triangles."""
        first = len(self.uv)
        self.uv += uv.reshape(-1, 2).tolist()
        m, n = vertex.shape
        faces = []
        for i, j in itertools.product(range(m - 1), range(n - 1)):
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            face = [(int(vertex[a, b]), first + a * n + b) for a, b in ring]
            if face[0][0] == face[3][0]:
                # a point: its one place in UV is that of the first
                face = [(face[0][0], first), *face[1:3]]
            faces.append(face)
        self.charts[name] = faces


def tube(
    n: int = 20, rows: int = 10, radius: float = 0.16, height: float = 0.4
) -> Charted:
    """A skirt: a tube about y of two charts, whose faces look out."""
    made = Charted()
    angle = np.pi * np.arange(2 * n) / n
    for y in np.linspace(0.6, 0.6 + height, rows + 1):
        ring = np.stack([np.cos(angle), np.full(2 * n, y / radius), np.sin(angle)], 1)
        made.x += (radius * ring).tolist()
    side = 2 * radius * np.sin(np.pi / (2 * n))
    for k, name in enumerate(("left", "right")):
        i, j = np.meshgrid(np.arange(n + 1), np.arange(rows + 1), indexing="ij")
        uv = np.stack([-i * side + k, j * height / rows], 2)
        made.grid(name, (i + k * n) % (2 * n) + j * 2 * n, uv)
    return flipped(made, made.charts)


def cone(n: int = 24, rows: int = 8, side: float = 0.2) -> Charted:
    """A hat: a cone about y of one chart, a disc with a dart of 60 degrees."""
    made, part = Charted(), 5 / 6
    around = np.arange(n + 1)
    made.x.append([0, 0.6, 0])
    number = np.zeros((rows + 1, n + 1), np.int64)
    for j in range(1, rows + 1):
        s = side * j / rows
        angle = 2 * np.pi * np.arange(n) / n
        drop = 0.6 - s * np.sqrt(1 - part**2)
        ring = [part * s * np.cos(angle), np.full(n, drop), part * s * np.sin(angle)]
        number[j] = len(made.x) + around % n
        made.x += np.stack(ring, 1).tolist()
    angle = -2 * np.pi * part * around / n
    s = side * np.arange(rows + 1)[:, None, None] / rows
    made.grid("hat", number, s * np.stack([np.cos(angle), np.sin(angle)], 1))
    return flipped(made, made.charts)


def cushion(n: int = 32, rows: int = 6, radius: float = 0.15) -> Charted:
    """Two discs, 2 mm apart but at their rim, where they are sewn all around."""
    made = Charted()
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.arange(n)
    made.x += (radius * np.stack([np.cos(angle), 0 * rim, np.sin(angle)], 1)).tolist()
    for name, y in (("upper", 0.004), ("lower", -0.004)):
        number = np.zeros((rows + 1, n + 1), np.int64)
        number[0], number[rows] = len(made.x), np.append(rim, 0)
        made.x.append([0, y, 0])
        uv = np.zeros((rows + 1, n + 1, 2))
        for j in range(rows + 1):
            s = radius * j / rows
            at = np.append(angle, 0)
            uv[j] = s * np.stack([np.cos(at), -np.sin(at)], 1)
            if 0 < j < rows:
                ring = [s * np.cos(angle), np.full(n, y), s * np.sin(angle)]
                number[j] = len(made.x) + np.append(rim, 0)
                made.x += np.stack(ring, 1).tolist()
        made.grid(name, number, uv)
        for face in made.charts[name]:  # a full turn ends where it begins
            for k, (v, t) in enumerate(face):
                row, column = divmod(t - (len(made.uv) - uv.shape[0] * (n + 1)), n + 1)
                if column == n:
                    face[k] = (v, t - n)
                del row
    return flipped(made, ["upper"])


def flipped(made: Charted, names: Any) -> Charted:
    """Turns the faces of some charts over."""
    for name in list(names):
        made.charts[name] = [face[::-1] for face in made.charts[name]]
    return made
