# SPDX-License-Identifier: Apache-2.0
"""Films of runs, .mp4 and .gif: the tool makes the pictures, and ffmpeg the film."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from drape import _whole, tool
from drape.errors import Error, SceneError, need
from drape.export.run import Run

ENDINGS = (".mp4", ".gif")
# A film as a GIF, whose times are hundredths of a second, with colours of its own.
GIF = "fps=20,split[a][b];[a]palettegen[c];[b][c]paletteuse"


def ffmpeg() -> str:
    """Returns ffmpeg: that in PATH, or else that of the package imageio-ffmpeg."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    package = need("imageio_ffmpeg", "a film without ffmpeg", "imageio-ffmpeg")
    return str(package.get_ffmpeg_exe())


def film(
    run: Run | str | os.PathLike[str],
    to: str | os.PathLike[str],
    *,
    every: int = 1,
    width: int = 800,
    height: int = 600,
    samples: int = 8,
    rate: int | None = None,
) -> Path:
    """Makes a film of a run, or of the run in a folder, by the scene's camera or one
    that sees all, in real time. Nothing is written into the run's folder.

    Args:
        run: what `World.record` or ``drape run`` wrote
        to: a name that ends in .mp4 or .gif; a .gif has 20 pictures a second
        every: every `every`-th frame only
        width, height: in pixels
        samples: a pixel
        rate: pictures a second of the .mp4; default: so many that a second is one

    Returns:
        the path of the film

    Raises:
        Error: there is no ffmpeg: install it, or the package imageio-ffmpeg
    """
    folder = run.folder if isinstance(run, Run) else Run(Path(run)).folder
    path = Path(to)
    if path.suffix.lower() not in ENDINGS:
        raise SceneError(f"{path}: expected a name that ends in {' or '.join(ENDINGS)}")
    program = ffmpeg()
    with (
        tempfile.TemporaryDirectory(prefix="drape-") as work,
        _whole.beside(path) as part,
    ):
        mine = Path(work) / "run"
        mine.mkdir()
        for each in folder.iterdir():
            if each.name not in ("pictures", "film.mp4"):
                (mine / each.name).symlink_to(each.absolute())
        (Path(work) / "ffmpeg").symlink_to(program)
        options = {"every": every, "width": width, "height": height, "rate": rate}
        given = {**options, "samples": samples}.items()
        words = [w for k, v in given if v is not None for w in (f"--{k}", v)]
        tool.call("render", mine, *words, programs=work)
        if path.suffix.lower() == ".gif":
            _gif(program, mine / "film.mp4", part)
        else:
            shutil.move(mine / "film.mp4", part)
    return path


def _gif(program: str, film: Path, to: Path) -> None:
    """Turns a film into a GIF."""
    words = ["-nostdin", "-v", "error", "-y", "-i", str(film), "-vf", GIF, str(to)]
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode:
        raise Error(f"ffmpeg: {done.stderr.strip() or done.returncode}")


def write(run: Run, frames: list[int], path: Path) -> None:
    """Makes a film of these frames of the run, evenly spaced."""
    every = run.frames().index(frames[1]) if len(frames) > 1 else 1
    film(run, path, every=every)
