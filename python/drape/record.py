# SPDX-License-Identifier: Apache-2.0
"""The files of a run, written as the tool writes them, and pictures."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import _whole, tool
from ._closing import Closing
from ._core import ffi, lib
from ._define import Handle
from ._library import Guard
from .errors import Error, SceneError, check_code


class Recorder(Closing):
    """Writes a world's run to a folder; `World.record` makes one."""

    def __init__(
        self,
        handle: Handle,
        guard: Guard,
        folder: str | os.PathLike[str],
        how: Any,
    ) -> None:
        """Claims the folder, and writes the world's state as frame 0."""
        self.folder = Path(folder)
        self.steps = 0
        self.on_close: Callable[[], None] = lambda: None
        self._handle = handle
        self._guard = guard
        self._run = ffi.NULL
        run = ffi.new("core_run **")
        name = os.fsencode(self.folder)
        with guard:
            self._claim(name, how, run)
            self._run = run[0]
            try:
                check_code(lib.core_run_frame(self._run, handle.world, 0))
            except BaseException:
                self._end(None)
                raise

    def _claim(self, name: bytes, how: Any, run: Any) -> None:
        handle = self._handle
        try:
            check_code(lib.core_run_open(handle.scene, handle.world, name, how, run))
        except SceneError as error:
            words = (
                str(error).replace("--out", "folder").replace("--force", "force=True")
            )
            raise SceneError(words) from None

    def add(self, report: Any) -> None:
        """Adds a step's report, and the frame that is due. The world's guard is
        held."""
        if report.outcome & lib.DRAPE_DIVERGED == 0:
            self.steps += 1
        check_code(lib.core_run_add(self._run, self._handle.world, report))
        frame, rest = divmod(self.steps, self._handle.scene.steps_per_frame)
        if rest == 0:
            check_code(lib.core_run_frame(self._run, self._handle.world, frame))

    def _end(self, end: bytes | None) -> None:
        run, self._run = self._run, ffi.NULL
        if run:
            frame = self.steps // self._handle.scene.steps_per_frame
            name = ffi.NULL if end is None else end
            check_code(lib.core_run_close(run, self._handle.world, frame, name))

    def close(self, end: str = "complete") -> None:
        """Writes the run's report, which calls its end `end`."""
        self.on_close()
        with self._guard:
            self._end(end.encode())

    def _leave(self, failed: bool) -> None:
        """An exception makes the run one that failed."""
        self.close("failed" if failed else "complete")


def picture(
    handle: Handle, guard: Guard, path: Path, width: int, height: int, samples: int
) -> Path:
    """Makes a picture of a world's state: a run of one frame, and the tool."""
    if path.suffix.lower() != ".png":
        raise Error(f"{path}: expected a name that ends in .png")
    if not path.parent.is_dir():
        raise Error(f"{path}: there is no folder {path.parent}")
    with tempfile.TemporaryDirectory(prefix="drape-") as folder:
        Recorder(handle, guard, folder, ffi.new("core_run_how *")).close()
        tool.call(
            "render",
            folder,
            "--frame",
            0,
            "--width",
            width,
            "--height",
            height,
            "--samples",
            samples,
        )
        made = Path(folder) / "pictures/frame_0000.png"
        _whole.write(path, made.read_bytes())
    return path
