# SPDX-License-Identifier: Apache-2.0
"""drape sew MESH.obj: sews a mesh whose UV charts are its panels, and writes it anew
for each frame."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from .errors import DivergedError, Error, SceneError
from .export.console import (
    FAILED,
    FINDINGS,
    OK,
    USAGE,
    Parser,
    complain,
    say,
    whole,
)
from .sewing import sew
from .uvmesh import UVMesh


def positive(text: str) -> float:
    """Reads metres above 0."""
    try:
        found = float(text)
    except ValueError:
        found = 0
    if not 0 < found < 1e9:
        raise argparse.ArgumentTypeError(f"{text}: expected metres above 0")
    return found


def _parser() -> Parser:
    parser = Parser(
        prog="drape sew",
        description="Sew a mesh whose UV charts are panels, and drape it on a body.",
    )
    add = parser.add_argument
    add("mesh", metavar="MESH.obj", help="with UVs, y up")
    add("--unit", type=positive, default=1.0, metavar="M", help="m, of its vertices")
    add("--body", metavar="MESH", help="that wears it, in metres")
    add("--cell", type=positive, metavar="H", help="m, side of a cell")
    add("--fabric", metavar="NAME", help="of drape materials")
    add("--frames", type=lambda text: whole(text, 0), metavar="N", help="at most")
    add("--out", metavar="DIR", help="where to write (default: the name)")
    add("--every", type=whole, default=1, metavar="N", help="every N-th frame only")
    add("--force", action="store_true", help="remove another run's files first")
    add("--no-picture", action="store_true", help="no pictures of the end")
    add("--backend", choices=["ref", "gpu"], help="who computes")
    add("--precision", type=int, choices=[32, 64], help="bits of a number")
    add("--threads", type=lambda text: whole(text, 0, 4096), metavar="N", help="0: all")
    add(
        "--block", type=lambda text: whole(text, 0, 256), metavar="N", help="of the GPU"
    )
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """`drape sew MESH.obj`; returns the exit code."""
    given = _parser().parse_args(argv)
    names = ("backend", "precision", "threads", "block")
    keys = {
        key: getattr(given, key) for key in names if getattr(given, key) is not None
    }

    def tell(line: str) -> None:
        if not given.quiet:
            complain(OK, line)

    file = Path(given.mesh)
    folder = Path(given.out or f"{file.stem}.out")
    try:
        made = sew(
            UVMesh(file, unit=given.unit),
            given.body,
            cell=given.cell,
            material=given.fabric,
            folder=folder,
            frames=given.frames,
            every=given.every,
            pictures=not given.no_picture,
            force=given.force,
            log=tell,
            **keys,
        )
        meshes = folder / "mesh"
        meshes.mkdir(exist_ok=True)
        for old in meshes.glob(f"{file.stem}_*.obj"):
            old.unlink()
        count = made.save_mesh(meshes / f"{file.stem.replace('%', '_')}_%04d.obj")
    except DivergedError as error:
        return complain(FINDINGS, f"sew: {error}")
    except SceneError as error:
        text = str(error).replace("another folder", "another --out")
        return complain(USAGE, f"sew: {text.replace('force=True', '--force')}")
    except Error as error:
        return complain(FAILED, f"sew: {error}")
    closed = len(made.seams) - len(made.open)
    if not given.quiet:
        say(
            f"{folder}: {made.steps} steps, {made.end}; {closed} of {len(made.seams)} "
            f"seams closed; {count} meshes in {meshes}"
        )
    return OK if made.clean and not made.open else FINDINGS
