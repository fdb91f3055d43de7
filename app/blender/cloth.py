# SPDX-License-Identifier: Apache-2.0
"""What drape makes of a mesh of Blender: a sheet where it is a grid of quads, else a
garment whose UV charts are panels.

drape has +y up and Blender +z: drape's (x, y, z) is Blender's (x, -z, y).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bmesh
import numpy as np
from numpy.typing import NDArray

from . import grid

Positions = NDArray[np.float64]
UNEVEN = 0.05  # above which a grid's edges are no cells of one size


class BakeError(Exception):
    """A scene that cannot be baked; the text names the object."""


def to_drape(x: Positions) -> Positions:
    """Positions in Blender's world as drape's."""
    return np.stack([x[..., 0], x[..., 2], -x[..., 1]], -1)


def to_blender(x: Positions) -> Positions:
    """Positions of drape as those in Blender's world."""
    return np.stack([x[..., 0], -x[..., 2], x[..., 1]], -1)


def _faces(mesh: Any) -> list[tuple[int, ...]]:
    """The faces of a mesh, with the triangles that two and two are quads joined."""
    if all(len(p.vertices) == 4 for p in mesh.polygons):
        return [tuple(p.vertices) for p in mesh.polygons]
    made = bmesh.new()
    try:
        made.from_mesh(mesh)
        triangles = [f for f in made.faces if len(f.verts) == 3]
        bmesh.ops.join_triangles(
            made,
            faces=triangles,
            angle_face_threshold=np.pi,
            angle_shape_threshold=np.pi,
        )
        return [tuple(v.index for v in f.verts) for f in made.faces]
    finally:
        made.free()


class Sheet:
    """A grid: a rectangle of cloth, of which cells may be missing."""

    kind = "cloths"  # the list of a scene that it is in
    bodies = 1

    def __init__(self, mesh: Any, x: Positions) -> None:
        """Finds the rows and columns of a mesh whose vertices are at x; or NoGrid."""
        faces = _faces(mesh)
        self.rows = grid.order(faces, len(x))
        self.missing = grid.missing(self.rows, faces)
        *self.size, uneven = grid.size(self._laid(x))
        if not uneven <= UNEVEN:
            raise grid.NoGrid(
                f"its rows and columns are uneven, by {100 * uneven:.2g} %; expected "
                f"at most {100 * UNEVEN:g} %"
            )
        self.start = x

    def _laid(self, values: Positions) -> Positions:
        """Values of vertices by rows and columns; NaN where there is no vertex."""
        return np.where(self.rows[..., None] < 0, np.nan, values[self.rows])

    def keys(self) -> dict[str, Any]:
        """What a scene of drape says of it, beside its name and its material."""
        n, m = self.rows.shape
        h, g = self.size[0] / (m - 1), self.size[1] / (n - 1)
        return {
            "particles": [m, n],
            "size": self.size,
            "positions": np.nan_to_num(self.sampled(self.start)),
            "cuts": [
                {
                    "rect": [
                        (i + a) * s for a in (0.25, 0.75) for i, s in ((c, h), (r, g))
                    ]
                }
                for c, r in self.missing
            ],
        }

    def sampled(self, values: Positions) -> Positions:
        """What the particles have of values of the vertices; NaN: there is none."""
        laid = self._laid(values)
        return laid.reshape(-1, laid.shape[-1])

    def carried(self, x: Positions) -> Positions:
        """Where the vertices are when the particles are at x."""
        there = self.rows.ravel() >= 0
        mine = np.empty_like(self.start)
        mine[self.rows.ravel()[there]] = x[there]
        return mine


def _write(path: Path, name: str, mesh: Any, x: Positions) -> None:
    """Writes a mesh whose vertices are at x as OBJ, with its active UVs. Blender's
    own exporter takes the mesh with all its modifiers, and what is selected."""
    corner = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corner)
    layer = mesh.uv_layers.active
    lines = [f"o {name}"]
    lines += [f"v {a:.9g} {b:.9g} {c:.9g}" for a, b, c in x.tolist()]
    words = [str(k + 1) for k in corner.tolist()]
    if layer:
        uv = np.empty(2 * len(corner), np.float32)
        layer.uv.foreach_get("vector", uv)
        lines += [f"vt {u:.9g} {v:.9g}" for u, v in uv.reshape(-1, 2).tolist()]
        words = [f"{word}/{k + 1}" for k, word in enumerate(words)]
    for p in mesh.polygons:
        lines.append("f " + " ".join(words[k] for k in p.loop_indices))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class Garment:
    """A mesh with UV charts, each of which is a panel (drape.UVMesh)."""

    kind = "garments"

    def __init__(self, thing: Any, x: Positions, folder: Path) -> None:
        """Finds the charts of an object whose vertices are at x; or a BakeError."""
        import drape

        self.cell, self.folder = thing.drape.cell, folder
        file = folder / "mesh.obj"
        _write(file, thing.name, thing.data, x)
        try:
            self.mesh = drape.UVMesh(file, strain=thing.drape.strain)
            self.bodies = len(self.mesh.charts)
            self.mesh.start(self.cell)
        except drape.SceneError as error:
            raise BakeError(str(error).replace(f"{file}: ", "")) from None

    def keys(self) -> dict[str, Any]:
        """What a scene of drape says of it, beside its name and its material."""
        made = self.mesh.garment(self.folder, cell=self.cell)
        return {"pattern": made.pattern, "cell": self.cell, "sewn": made.sewn}

    def sampled(self, values: Positions) -> Positions:
        """What the particles have of values of the vertices; NaN: no cell has them."""
        return self.mesh.sampled(values, self.cell)

    def carried(self, x: Positions) -> Positions:
        """Where the vertices are when the particles are at x."""
        return self.mesh.carried(x, self.cell)


def make(thing: Any, x: Positions, folder: Path) -> Sheet | Garment:
    """Returns what drape makes of an object whose vertices are at x, [n, 3] m in its
    own axes, with files in a folder; a BakeError that says what it could take."""
    try:
        return Sheet(thing.data, x)
    except grid.NoGrid as error:
        no_grid = error
    try:
        return Garment(thing, x, folder)
    except BakeError as error:
        raise BakeError(
            f"{thing.name}: it is no grid of quads, {no_grid}; and as a garment of UV "
            f"charts: {error}"
        ) from None
