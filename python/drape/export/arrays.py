# SPDX-License-Identifier: Apache-2.0
"""The bodies of a world or a run as arrays, and their files: .npz of all frames, and
a file a frame of PLY or of what meshio writes, as OBJ, STL, VTK."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drape import _meshes, _whole
from drape._endings import FRAME
from drape.errors import Error, need
from drape.export.run import Run

if TYPE_CHECKING:
    from drape.world import World

Data = dict[str, NDArray[Any]]
CELLS = (".vtk", ".vtu")  # those that say of each triangle which body it is of


def _bodies(
    names: Sequence[str],
    kinds: Sequence[str],
    vertices: Sequence[tuple[int, int]],
    triangles: Sequence[tuple[int, int]],
    sizes: Sequence[tuple[float, float] | None],
) -> Data:
    """What all files of arrays have of the bodies."""
    return {
        "body_names": np.array(names),
        "body_kinds": np.array(kinds),
        "body_vertices": np.array(vertices, np.int64).reshape(-1, 2),
        "body_triangles": np.array(triangles, np.int64).reshape(-1, 2),
        "body_size": np.array([size or (np.nan, np.nan) for size in sizes]),
    }


def of_world(world: World) -> Data:
    """Returns what does not change with a world's steps: `triangles` [k, 3]; `rest`
    [vertices, 2] m on the sheet at rest, NaN of obstacles; `uv`, the same by the
    sheet's size; and of each body, in their order, `body_names`, `body_kinds`,
    `body_size` [bodies, 2] m at rest, and where its rows begin and end,
    `body_vertices` and `body_triangles` [bodies, 2]."""
    rest = np.full((len(world), 2), np.nan)
    uv = rest.copy()
    for body in world.bodies:
        if body.size is not None:
            rest[body.vertices] = body.rest
            uv[body.vertices] = body.rest / body.size
    bodies = world.bodies
    return {
        "triangles": np.array(world.triangles),
        "rest": rest,
        "uv": uv.astype(np.float32),
        **_bodies(
            [each.name for each in bodies],
            [each.kind for each in bodies],
            [(each.vertices.start, each.vertices.stop) for each in bodies],
            [(each.triangles.start, each.triangles.stop) for each in bodies],
            [each.size for each in bodies],
        ),
    }


def of_run(run: Run) -> Data:
    """Returns the same of a run, whose particles in holes are left out."""
    bodies = run.bodies
    v = np.cumsum([0, *(len(each.rows) for each in bodies)])
    t = np.cumsum([0, *(len(each.faces) for each in bodies)])
    uv = np.full((int(v[-1]), 2), np.nan, np.float32)
    rest = np.full((int(v[-1]), 2), np.nan)
    for k, body in enumerate(bodies):
        if body.uv is not None and body.rest is not None:
            uv[v[k] : v[k + 1]] = body.uv
            rest[v[k] : v[k + 1]] = body.rest
    spans = [list(pairwise(each)) for each in (v, t)]
    return {
        "triangles": np.concatenate(
            [each.faces + v[k] for k, each in enumerate(bodies)]
        ).astype(np.int32),
        "rest": rest,
        "uv": uv,
        **_bodies(
            [each.name for each in bodies],
            [each.kind for each in bodies],
            spans[0],
            spans[1],
            [each.size for each in bodies],
        ),
    }


def write_frame(path: Path, x: NDArray[Any], data: Data) -> None:
    """Writes vertices at x, [vertices, 3] m, as one frame, by the file's ending."""
    tri, ending = data["triangles"], path.suffix.lower()
    if ending == ".ply":
        _whole.write(path, _meshes.ply(x, tri))
        return
    meshio = need("meshio", ending, "meshio")
    points: Data = {}
    cells: dict[str, list[NDArray[Any]]] = {}
    if ending in CELLS:
        body = np.zeros(len(tri), np.int32)
        for k, (first, last) in enumerate(data["body_triangles"]):
            body[first:last] = k
        cells = {"body": [body]}
        points = {"uv": np.column_stack([data["uv"], np.zeros(len(x), np.float32)])}
    made = meshio.Mesh(x, [("triangle", tri)], point_data=points, cell_data=cells)
    with _whole.beside(path) as part:
        made.write(part)


def write_arrays(path: Path, data: Data) -> None:
    """Writes arrays as a file of NumPy's."""
    with _whole.beside(path) as part:
        np.savez_compressed(part, **data)  # type: ignore[arg-type]


def write_run(run: Run, frames: list[int], path: Path) -> None:
    """Writes frames of a run as arrays: `frames` [f, vertices, 3] m, `times` [f] s and
    `frame_dt` s, with what `of_run` returns."""
    data = of_run(run)
    x = np.stack([all_of(run, frame) for frame in frames])
    apart = frames[1] - frames[0] if len(frames) > 1 else 1
    times = np.array(frames) * run.seconds
    more: Data = {
        "frames": x,
        "times": times,
        "frame_dt": np.array(apart * run.seconds),
    }
    write_arrays(path, {**more, **data})


def all_of(run: Run, frame: int) -> NDArray[Any]:
    """Returns the vertices of all bodies in a frame, [vertices, 3] m."""
    return np.concatenate([run.positions(body, frame) for body in run.bodies])


def write_world(world: World, path: Path) -> None:
    """Writes a world's state now, by the file's ending."""
    kind = np.dtype(f"<f{world.precision // 8}")
    x, v = (each.astype(kind) for each in world.read())
    _whole.need_folder(path)
    data = of_world(world)
    if path.suffix.lower() == ".npz":
        time = np.array(world.time)
        write_arrays(path, {"positions": x, "velocities": v, "time": time, **data})
    elif path.suffix.lower() in FRAME:
        write_frame(path, x, data)
    else:
        raise Error(f"{path}: expected a name that ends in .npz, {', '.join(FRAME)}")
