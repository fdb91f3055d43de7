# SPDX-License-Identifier: Apache-2.0
"""drape audit of frames that any program has made: what intersects in each, and what
touches on the straight way from each to the next, decided exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import Error, SceneError
from .export.console import FAILED, FINDINGS, OK, USAGE, Parser, complain, say
from .mesh import audit, ccd_mesh
from .meshes import Mesh, read_meshes
from .scene import array


@dataclass(frozen=True)
class Verdict:
    """What was found in a frame.

    Attributes:
        frame: its number, from 0
        pairs: pairs of triangles that intersect
        degenerate: triangles without area, which are in no pair
        passing: pairs of a vertex and a face, or of edges, that touch on the straight
            way from the frame before; None: nobody asked, or it is the first
    """

    frame: int
    pairs: int
    degenerate: int
    passing: int | None


def audit_frames(
    frames: ArrayLike,
    triangles: ArrayLike,
    group: ArrayLike | None = None,
    *,
    between: bool = False,
    threads: int = 0,
) -> list[Verdict]:
    """Audits each frame of a mesh, which any program may have made.

    Args:
        frames: [f, n, 3] m
        triangles: [k, 3] numbers of vertices, as in all frames
        group: [k] 0: of an obstacle; two such triangles are not compared
        between: whether the way from each frame to the next is looked at, too: what
            touches while all vertices go in straight lines
        threads: 0: as many as processors; the number changes no result
    """
    x = array(frames, (None, None, 3), "frames")
    tri = array(triangles, (None, 3), "triangles", np.int32)
    still = None
    if group is not None:
        group = array(group, (len(tri),), "group", np.int32)
        still = np.ones(x.shape[1], bool)
        still[tri[group != 0]] = False  # vertices of obstacles
    found = []
    for k, now in enumerate(x):
        each = audit(now, tri, group, threads=threads)
        passing = None
        if between and k:
            touches = ccd_mesh(x[k - 1], now, tri, threads=threads)
            passing = len(touches)
            if still is not None:
                passing -= int(still[touches.vertices].all(axis=1).sum())
        found.append(Verdict(k, each.count, each.degenerate, passing))
    return found


def _frames(mesh: Mesh) -> NDArray[Any]:
    return mesh.vertices[None] if mesh.frames is None else mesh.frames


def _stacked(meshes: Sequence[Mesh], groups: Sequence[int]) -> tuple[Any, Any, Any]:
    """Returns frames, triangles and groups of meshes as one."""
    most = max(len(_frames(each)) for each in meshes)
    parts, faces, group, first = [], [], [], 0
    for mesh, number in zip(meshes, groups, strict=True):
        x = _frames(mesh)
        if len(x) not in (1, most):
            raise SceneError(f"{mesh.name}: {len(x)} frames; the others have {most}")
        parts.append(np.broadcast_to(x, (most, *x.shape[1:])))
        faces.append(mesh.triangles + first)
        group += [number] * len(mesh.triangles)
        first += x.shape[1]
    return np.concatenate(parts, axis=1), np.concatenate(faces), np.array(group)


def _series(files: Sequence[str]) -> Mesh:
    """Returns files of a frame each as one mesh that moves."""
    frames, first = [], None
    for file in files:
        meshes = list(read_meshes(file).values())
        x, tri, _ = _stacked(meshes, [1] * len(meshes))
        first = tri if first is None else first
        if len(x) > 1:
            raise SceneError(f"{file}: {len(x)} frames; --frames takes one a file")
        if tri.shape != first.shape or (tri != first).any():
            raise SceneError(
                f"{file}: other triangles than those of {files[0]}; expected frames of "
                "one mesh, as of PLY, whose vertices stay as they are"
            )
        frames.append(x[0])
    assert first is not None
    return Mesh(Path(files[0]).name, frames[0], first, np.stack(frames))


def _read(files: Sequence[str], series: bool, obstacle: str | None) -> tuple[Any, ...]:
    """Returns frames, triangles and groups of what the command line names."""
    meshes = [_series(files)] if series else []
    for file in () if series else files:
        meshes += read_meshes(file).values()
    groups = [0 if m.kind == "obstacle" else k + 1 for k, m in enumerate(meshes)]
    if obstacle:
        more = list(read_meshes(obstacle).values())
        meshes, groups = meshes + more, groups + [0] * len(more)
    return _stacked(meshes, groups)


def main(argv: Sequence[str]) -> int:
    """`drape audit` of what the tool does not read; returns the exit code."""
    parser = Parser(
        prog="drape audit",
        description="Count intersecting triangle pairs of frames, exactly.",
    )
    parser.add_argument("files", metavar="FILE", nargs="+")
    parser.add_argument(
        "--frames", action="store_true", help="each file is a frame of one mesh"
    )
    parser.add_argument(
        "--between",
        action="store_true",
        help="also count what touches on the straight way between two frames",
    )
    parser.add_argument("--obstacle", metavar="FILE", help="not against itself")
    parser.add_argument("--list", action="store_true", help="print each frame's counts")
    given = parser.parse_args(argv)
    name = given.files[0] if len(given.files) == 1 else f"{len(given.files)} files"
    try:
        x, tri, group = _read(given.files, given.frames, given.obstacle)
        found = audit_frames(x, tri, group, between=given.between)
    except SceneError as error:
        return complain(USAGE, f"audit: {error}")
    except Error as error:
        return complain(FAILED, f"audit: {error}")
    return _tell(name, len(tri), found, given.list)


def _tell(name: str, triangles: int, found: list[Verdict], listed: bool) -> int:
    """Prints what was found, and returns the exit code."""
    for each in found:
        if listed or each.pairs or each.passing:
            words = f"frame {each.frame}: {triangles} triangles, "
            words += f"{each.pairs} intersecting pairs"
            if each.degenerate:
                words += f", {each.degenerate} degenerate triangles"
            if each.passing is not None:
                words += (
                    f"; {each.passing} touch on the way from frame {each.frame - 1}"
                )
            say(words)
    pairs = [each.pairs for each in found]
    bad = sum(count > 0 for count in pairs)
    words = f"{name}: {len(found)} frames, {bad} of them with intersecting pairs, "
    words += f"{sum(pairs)} pairs"
    ways = [each.passing for each in found if each.passing is not None]
    if ways:
        bad = sum(count > 0 for count in ways)
        words += f"; {len(ways)} ways, {bad} of them with pairs that touch, "
        words += f"{sum(ways)} pairs"
    say(words)
    return FINDINGS if sum(pairs) + sum(ways) else OK
