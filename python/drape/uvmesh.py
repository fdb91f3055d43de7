# SPDX-License-Identifier: Apache-2.0
"""Meshes whose UV charts are panels: app/patterns/README.md §12."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _charts, _inside, _meshes, _obj, _whole
from . import scene as scenes
from ._core import ffi
from ._define import read_scene
from .errors import SceneError

Array = NDArray[Any]

CELL = 0.005  # m: app/scene/garments.c
STRAIN = 0.05  # of a chart against its UVs, above which it is refused
SIZES = (0.005, 20.0)  # m, of a panel: app/read/pattern.c


@dataclass(frozen=True, eq=False, repr=False)
class Chart:
    """A chart of a mesh: a panel.

    Attributes:
        name: of the file's group or object, with a number where several have it
        faces: numbers of its faces, from 0 in the file's order
        scale: m of cloth for a unit of UV
        strain: against its UVs, the root mean square over its area; 0.01: 1 %
        mirrored: whether its UVs show it from its wrong side
    """

    name: str
    faces: NDArray[np.int64]
    scale: float
    strain: float
    mirrored: bool

    def __repr__(self) -> str:
        """The chart in one line."""
        mirrored = ", mirrored" if self.mirrored else ""
        return (
            f"<drape.Chart {self.name!r}: {len(self.faces)} faces, strained by "
            f"{100 * self.strain:.2g} %{mirrored}>"
        )


class UVMesh:
    """A mesh with UV charts: each chart is a panel of cloth, and where charts share
    vertices they are sewn. It starts where the mesh is, and the cloth carries the mesh:
    its faces and its UVs stay as they are.

    Attributes:
        file: its path
        charts: a `Chart` each, in the order of their first faces
        vertices: [n, 3] m
        unit: m, of the file
    """

    def __init__(
        self,
        file: str | os.PathLike[str],
        *,
        unit: float = 1,
        scale: float | None = None,
        strain: float = STRAIN,
    ) -> None:
        """Reads an OBJ file with +y up, and finds its charts and their seams.

        Args:
            file: whose faces have texture coordinates
            unit: m, of its vertices: 0.01 for centimetres
            scale: m of cloth for a unit of UV, the same for all charts; default: each
                chart is as large as it is in space
            strain: a chart that is strained by more against its UVs is refused, as
                these are no pattern of it; folds of few faces strain it, too

        Raises:
            SceneError: the file is no such mesh; the text names the line, the chart or
                the face, which counts from 1
        """
        self.file = Path(file)
        self.unit = scenes.number(unit, "unit")
        if not 0 < self.unit < np.inf:
            raise SceneError(f"unit: {unit!r}: expected metres above 0")
        self._obj = _obj.read(self.file)
        self.vertices = self._obj.x * self.unit
        self._sheet = _charts.Sheet(self._obj, self.vertices)
        given = None if scale is None else scenes.number(scale, "scale")
        if given is not None and not 0 < given < np.inf:
            raise SceneError(f"scale: {scale!r}: expected metres above 0")
        self.charts = [
            self._chart(k, given, scenes.number(strain, "strain"))
            for k in range(len(self._sheet.names))
        ]
        self._given = {"unit": self.unit, "scale": given, "strain": float(strain)}
        self._cuts: dict[float, list[_Cut]] = {}

    def __repr__(self) -> str:
        """The mesh in one line."""
        return (
            f"<drape.UVMesh {self.file.name!r}: {len(self.vertices)} vertices, "
            f"{len(self.charts)} charts>"
        )

    @classmethod
    def of_pattern(cls, file: str | os.PathLike[str]) -> UVMesh | None:
        """Returns the mesh that a pattern was made of, read anew; None: of no mesh."""
        made = json.loads(Path(file).read_text(encoding="utf-8"))
        mesh = made.get("properties", {}).get("mesh")
        return cls(**mesh) if mesh else None

    def _chart(self, k: int, given: float | None, most: float) -> Chart:
        """Returns chart k, if its UVs are a pattern of it."""
        sheet = self._sheet
        scale, strain, face = sheet.strain(k, given)
        name, file = sheet.names[k], self._obj.file
        size = float(np.ptp(sheet.plane[sheet.corners(k)], axis=0).max()) * scale
        if not SIZES[0] <= size <= SIZES[1]:
            raise SceneError(
                f"{file}: chart {name}: is {size:.3g} m large, expected {SIZES[0]} to "
                f"{SIZES[1]:g} m; is unit {self.unit:g} right?"
            )
        if not strain <= most:
            raise SceneError(
                f"{file}: chart {name}: is strained by {100 * strain:.3g} % against "
                f"its UVs, face {face[0] + 1} by {100 * face[1]:.3g} %; expected at "
                f"most {100 * most:.3g} % (strain={most:g}), as its UVs are to be its "
                "pattern"
            )
        return Chart(name, sheet.faces(k), scale, strain, bool(sheet.mirrored[k]))

    def pattern(self, cell: float = CELL) -> dict[str, Any]:
        """Returns its sewing pattern as `drape pattern` reads it, in metres: a panel a
        chart, whose y is the UVs' v, and a stitch each run of edges that two charts
        share.

        Args:
            cell: m: a seam is divided where its sides would be off by a quarter of it
        """
        scales = np.array([each.scale for each in self.charts])
        made = self._sheet.pattern(scales, cell)
        made["properties"]["mesh"] = {"file": str(self.file.resolve()), **self._given}
        return made

    def garment(
        self,
        folder: str | os.PathLike[str],
        *,
        cell: float = CELL,
        **keys: Any,
    ) -> scenes.Garment:
        """Writes its pattern and where its particles start into a folder, as files
        NAME.pattern.json and NAME.start.ply, and returns the garment of a scene.

        Args:
            folder: which must be there
            cell: m, side of a cell
            keys: further ones of a garment: name, material, look
        """
        pattern, start = self.files(folder)
        text = json.dumps(self.pattern(cell))
        mesh = _meshes.ply(self.start(cell), np.zeros((0, 3), np.int32))
        _whole.write(start, mesh)
        _whole.write(pattern, text.encode())
        return scenes.Garment(pattern=pattern, cell=cell, sewn=str(start), **keys)

    def files(self, folder: str | os.PathLike[str]) -> tuple[Path, Path]:
        """Returns what `garment` writes into a folder."""
        stem = self.file.stem
        return Path(folder, f"{stem}.pattern.json"), Path(folder, f"{stem}.start.ply")

    def start(self, cell: float = CELL) -> Array:
        """Returns where the particles of its panels are on the mesh, [particles, 3] m,
        in the order of the charts."""
        parts = []
        for each in self._cut(cell):
            x = each.sampled(self, self.vertices)
            there = ~np.isnan(x[:, 0])
            x[~there] = x[there].mean(0)  # those that no cell has are anywhere
            parts.append(x)
        return np.concatenate(parts)

    def sampled(self, values: Any, cell: float = CELL) -> Array:
        """Returns what the particles have of values of its vertices, as weights of
        paint or where an animation has them, [particles, k]: each by the triangle of
        the chart that it is in. NaN where no cell has the particle.

        Args:
            values: [n, k]
            cell: m, side of a cell
        """
        given = scenes.array(values, (len(self.vertices), None), "values")
        return np.concatenate([each.sampled(self, given) for each in self._cut(cell)])

    def carried(self, positions: Any, cell: float = CELL) -> Array:
        """Returns where its vertices are, [n, 3] m, when its particles are at
        positions, [particles, 3] m, as `Sewn.positions` or a world has them. A vertex
        on a seam is in the middle of its charts. One of no face stays where it is."""
        cuts = self._cut(cell)
        count = sum(each.count for each in cuts)
        x = scenes.array(positions, (None, 3), "positions")
        if len(x) != count:
            raise SceneError(
                f"positions: {len(x)} particles; {self.file.name} has {count} by cells "
                f"of {1e3 * cell:g} mm"
            )
        total, n = np.zeros_like(self.vertices), np.zeros(len(self.vertices))
        at = 0
        for each in cuts:
            place = (x[at + each.of] * each.part[:, :, None]).sum(1)
            for i in range(3):
                total[:, i] += np.bincount(each.vertex, place[:, i], len(n))
            n += np.bincount(each.vertex, minlength=len(n))
            at += each.count
        return np.where(
            n[:, None] > 0, total / np.maximum(n, 1)[:, None], self.vertices
        )

    def save(self, path: str | os.PathLike[str], vertices: Any) -> None:
        """Writes the mesh with its vertices elsewhere, [n, 3] m, in the file's own
        unit: the text is the file's but for its vertices and its normals, which are
        those of the new shape.

        Args:
            path: of an OBJ file
            vertices: as `carried` returns them
        """
        x = scenes.array(vertices, self.vertices.shape, "vertices")
        _obj.write(Path(path), self._obj, x / self.unit)

    def _cut(self, cell: float) -> list[_Cut]:
        """Returns the panels as `drape pattern` cuts them."""
        if cell not in self._cuts:
            self._cuts = {cell: list(self._make_cuts(cell))}
        return self._cuts[cell]

    def _make_cuts(self, cell: float) -> Iterator[_Cut]:
        with tempfile.TemporaryDirectory(prefix="drape-") as folder:
            file = Path(folder) / f"{self.file.stem}.json"
            file.write_bytes(json.dumps(self.pattern(cell)).encode())
            garment = {"pattern": str(file), "cell": cell}
            text = scenes.read({"garments": [garment]})
            try:
                made = read_scene(text, notes=False)
            except SceneError as error:
                said = str(error).replace(str(file), self._obj.file)
                raise type(error)(said.removeprefix("scene: ")) from None
            for k, chart in enumerate(self.charts):
                yield _Cut(self, k, chart.scale, getattr(made, "def").cloths[k])


class _Cut:
    """A chart as its panel is cut.

    Attributes:
        count: of particles
        vertex: [corners] of the mesh, each once for the chart
        of, part: [corners, 3] the particles that carry it, and by how much
        on: the particles that its cells have, and the corners that these are on
            likewise; None: nobody has asked yet
    """

    on: tuple[Array, Array, Array] | None = None

    def __init__(self, mesh: UVMesh, k: int, scale: float, cloth: Any) -> None:
        m, n = int(cloth.m), int(cloth.n)
        self.count, self.k = m * n, k
        panel = ffi.cast("struct cloth_panel *", cloth.panel)
        rest = np.frombuffer(ffi.buffer(panel.panel.rest, 16 * m * n)).reshape(-1, 2)
        kinds = np.frombuffer(ffi.buffer(panel.panel.cell, (m - 1) * (n - 1)), np.uint8)
        self.rest = (rest + np.array([panel.at[0], panel.at[1]])) / scale
        self.triangles = _triangles(kinds, m)
        corners = mesh._sheet.corners(k)
        self.vertex = mesh._sheet.vertex[corners]
        self.of, self.part = _inside.locate(
            self.rest, self.triangles, mesh._sheet.plane[corners]
        )

    def sampled(self, mesh: UVMesh, values: Array) -> Array:
        """What its particles have of values of the mesh's vertices, [n, k]."""
        sheet = mesh._sheet
        if self.on is None:
            there = np.unique(self.triangles)
            tri = sheet.triangles(self.k)
            self.on = there, *_inside.locate(sheet.plane, tri, self.rest[there])
        there, of, part = self.on
        made = np.full((self.count, values.shape[1]), np.nan)
        made[there] = (values[sheet.vertex][of] * part[:, :, None]).sum(1)
        return made


def _triangles(kinds: Array, m: int) -> Array:
    """The triangles of the cells of a panel, by enum drape_cell (cloth/cloth.md §1)."""
    cell = np.arange(len(kinds))
    p = cell % (m - 1) + m * (cell // (m - 1))
    corner = np.stack([p, p + 1, p + m + 1, p + m], 1)
    rising, falling = (kinds == 1) | (kinds == 2), kinds == 3
    parts = [
        corner[rising][:, [0, 1, 2]],
        corner[rising][:, [0, 2, 3]],
        corner[falling][:, [0, 1, 3]],
        corner[falling][:, [1, 2, 3]],
    ]
    for k in range(4):
        parts.append(corner[kinds == 4 + k][:, [i for i in range(4) if i != k]])
    return np.concatenate(parts)
