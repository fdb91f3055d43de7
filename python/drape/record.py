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
from ._signals import Held
from .errors import Error, SceneError, check_code


class Recorder(Closing):
    """Writes a world's run to a folder; `World.record` makes one."""

    def __init__(
        self, handle: Handle, folder: str | os.PathLike[str], how: Any
    ) -> None:
        """Claims the folder, and writes the world's state as frame 0."""
        self.folder = Path(folder)
        self.steps = 0
        self.fault: Error | None = None
        """Why a step or a frame could not be written; None: all are."""
        self.on_close: Callable[[], None] = lambda: None
        self._handle = handle
        self._run = ffi.NULL
        run = ffi.new("core_run **")
        name = os.fsencode(self.folder)
        with Held(), handle.lock:
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

    def refuse_gap(self) -> None:
        """Refuses a further step where one of those before it is not written."""
        if self.fault:
            raise Error(
                f"{self.folder}: the run can be recorded no further, as step "
                f"{self.steps} is not written ({self.fault}); close the recorder to "
                "go on without it"
            )

    def add(self, report: Any) -> None:
        """Adds a step's report, and the frame that is due. The world's lock is
        held."""
        try:
            self._add(report)
        except Error as error:
            self.fault = error
            raise

    def _add(self, report: Any) -> None:
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
        """Writes the run's report, which calls its end `end`, or "failed" where a
        step could not be written."""
        with Held(), self._handle.lock:
            self.on_close()
            self._end(b"failed" if self.fault else end.encode())

    def _leave(self, kind: type[BaseException] | None) -> None:
        """An exception makes the run one that failed or was interrupted."""
        stopped = kind is not None and issubclass(kind, KeyboardInterrupt)
        self.close(
            "complete" if kind is None else "interrupted" if stopped else "failed"
        )


def picture(handle: Handle, path: Path, width: int, height: int, samples: int) -> Path:
    """Makes a picture of a world's state: a run of one frame, and the tool."""
    if path.suffix.lower() != ".png":
        raise Error(f"{path}: expected a name that ends in .png")
    _whole.need_folder(path)
    with tempfile.TemporaryDirectory(prefix="drape-") as folder:
        Recorder(handle, folder, ffi.new("core_run_how *")).close()
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
