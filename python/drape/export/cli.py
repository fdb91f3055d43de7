# SPDX-License-Identifier: Apache-2.0
"""drape export: writes a run's frames as one file, or as a file a frame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from drape import _whole
from drape._endings import FRAME
from drape.errors import Error, SceneError, need
from drape.export import arrays, film
from drape.export.console import FAILED, OK, USAGE, Parser, complain, say, whole
from drape.export.run import Run, RunError, numbered

# By the file's ending: the module that writes it, and the package it needs.
FORMATS = {
    **{ending: ("usd", "usd-core") for ending in (".usdc", ".usda", ".usd")},
    ".glb": ("gltf", "pygltflib"),
    ".abc": ("alembic", "bpy"),
    **{ending: ("film", "imageio-ffmpeg") for ending in film.ENDINGS},
}
ENDINGS = ", ".join((*FORMATS, ".npz"))


def export(run: Run | str | Path, to: str | Path, every: int = 1) -> int:
    """Writes every `every`-th frame of a run, or of the run in a folder, into a
    file, by the file's ending: USD, glTF, Alembic, .npz, or a film, .mp4 or .gif; or
    each into a file of its own where the name has a number's place, as in
    ``frame_%04d.vtu``, and ends in .ply, .obj, .off, .stl, .vtk or .vtu.

    A file appears whole or not at all, in place of one that is there. Returns
    the number of frames in it. Raises SceneError, Error where the format's package
    is not installed, or OSError.
    """
    run = run if isinstance(run, Run) else Run(run)
    path = Path(to)
    _whole.need_folder(path)
    ending = path.suffix.lower()
    if ending in FRAME:
        return _frames(run, path, run.frames()[::every])
    if ending == ".npz":
        frames = run.frames()[::every]
        arrays.write_run(run, frames, path)
        return len(frames)
    form = FORMATS.get(ending)
    if not form:
        raise RunError(
            f"{path}: expected a name that ends in {ENDINGS}, or one a frame, as "
            f"frame_%04d.ply, in {', '.join(FRAME)}"
        )
    module = need(f"drape.export.{form[0]}", path.suffix, form[1])
    frames = run.frames()[::every]
    with _whole.beside(path) as part:
        module.write(run, frames, part.absolute())
    return len(frames)


def _frames(run: Run, path: Path, frames: list[int]) -> int:
    """Writes a file a frame."""
    numbered(path)
    data = arrays.of_run(run)
    for frame in frames:
        one = path.with_name(path.name % frame)
        arrays.write_frame(one, arrays.all_of(run, frame), data)
    return len(frames)


def main(argv: Sequence[str] | None = None) -> int:
    """`drape export`; returns the exit code."""
    parser = Parser(
        prog="drape export",
        description="Write the frames of a run as one file: USD, glTF, Alembic, "
        "arrays or a film; or as a file a frame.",
    )
    parser.add_argument("run", metavar="RUN", help="folder that `drape run` wrote")
    parser.add_argument(
        "--to",
        required=True,
        metavar="FILE",
        help=f"that ends in {ENDINGS}, or a name a frame as frame_%%04d.ply, in "
        + ", ".join(FRAME),
    )
    parser.add_argument(
        "--every", type=whole, default=1, metavar="K", help="every K-th frame only"
    )
    given = parser.parse_args(argv)
    try:
        run = Run(given.run)
        count = export(run, given.to, given.every)
    except SceneError as error:
        return complain(USAGE, f"export: {error}")
    except Error as error:
        return complain(FAILED, f"export: {error}")
    except OSError as error:
        return complain(FAILED, f"export: {given.to}: {error.strerror or error}")
    if given.quiet:
        return OK
    ending = Path(given.to).suffix.lower()
    if run.precision == 64 and ending in FORMATS and ending not in film.ENDINGS:
        complain(OK, "note: the run has 64 bits; the file's points have 32")
    if run.end != "complete":
        complain(OK, f"note: the run is {run.end}; these are its frames so far")
    say(f"{given.to}: {count} frames, {run.fps:g} a second")
    return OK
