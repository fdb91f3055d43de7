# SPDX-License-Identifier: Apache-2.0
"""A world as bytes: checkpoints, which hold its state, and logs, which hold what was
done to it and replay a session bit for bit (spec/control/control.md)."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from . import _whole
from ._core import ffi, lib
from ._define import Handle
from ._library import Calls
from ._signals import Held
from .errors import CheckpointError, Error, check, check_code
from .reports import Status, StepReport


class Saved:
    """What a `World` writes of itself and reads again."""

    _calls: Calls
    _log: Calls | None = None
    _now: tuple[int, float]
    _report: StepReport | None

    def _open(self) -> Handle:
        raise NotImplementedError

    def _begin(self) -> None:
        raise NotImplementedError

    def _call(self, name: str, where: str, *arguments: Any) -> int:
        raise NotImplementedError

    def _changed(self) -> None:
        raise NotImplementedError

    def _clock(self) -> tuple[int, float]:
        raise NotImplementedError

    def _done(self, report: Any) -> StepReport:
        raise NotImplementedError

    def _loaded(self) -> None:
        raise NotImplementedError

    def _may_change(self) -> None:
        raise NotImplementedError

    def _refresh(self) -> None:
        raise NotImplementedError

    def checkpoint(self) -> bytes:
        """Returns a checkpoint of the state, which `restore` takes."""
        handle = self._open()
        with handle.lock:
            self._calls.written = bytearray()
            status = lib.drape_save(handle.world, lib.core_write, self._calls.pointer)
            data, self._calls.written = self._calls.written, bytearray()
        check(status, "checkpoint")
        return bytes(data)

    def restore(self, data: bytes) -> None:
        """Replaces the state by a checkpoint's. The world continues with the
        same bits as the one that was saved, which had the same scene; backend
        and threads may differ.

        Raises:
            CheckpointError: it is damaged, or of another scene
        """
        self._may_change()
        with Held():
            before = self.checkpoint()
            left = self._restore(data)
            if left:
                self._restore(before)
            else:
                self._report = None
            self._refresh()
        if left:
            raise CheckpointError(f"checkpoint: {left} bytes behind its end")

    def _restore(self, data: bytes) -> int:
        """Loads a checkpoint and returns how many bytes are behind its end."""
        calls, handle = self._calls, self._open()
        with handle.lock:
            calls.unread = memoryview(data)
            status = lib.drape_load(handle.world, lib.core_read_bytes, calls.pointer)
            left, calls.unread = len(calls.unread), memoryview(b"")
            self._now = self._clock()
        self._loaded()
        if status == Status.EIO:
            raise CheckpointError("checkpoint: it ends too early")
        check(status, "checkpoint")
        return left

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a checkpoint to a file, which appears complete or not at all."""
        _whole.write(path, self.checkpoint())

    def load(self, path: str | os.PathLike[str]) -> None:
        """Replaces the state by that of a file that `save` wrote."""
        try:
            self.restore(Path(path).read_bytes())
        except CheckpointError as error:
            raise CheckpointError(f"{os.fspath(path)}: {error}") from error

    def start_log(self) -> None:
        """Begins a log: the state now, and then all that changes the world."""
        log = Calls(None, None)  # a checkpoint that is made meanwhile is not in it
        with Held():
            self._call("drape_record", "log", lib.core_write, log.pointer)
            self._log = log

    def end_log(self) -> bytes:
        """Ends the log and returns it; `replay` takes it."""
        if self._log is None:
            raise Error("log: none was begun")
        with Held():
            self._call("drape_record", "log", ffi.NULL, ffi.NULL)
            log, self._log = self._log, None
        return bytes(log.written)

    def replay(self, log: bytes) -> Iterator[StepReport]:
        """Makes the calls of a log again, and returns the report of each step
        when it is done. The bits are those of the world that was logged. Bodies
        that the log adds are called "cloth" and "obstacle"."""
        unread = memoryview(log)
        self._may_change()
        self._begin()
        while True:
            with Held():
                status, unread, report = self._replay_step(unread)
            if status == Status.EIO or (status == 0 and unread):
                raise CheckpointError("log: it ends within a call")
            if check(status, "log") == 0:
                return
            yield report

    def _replay_step(self, unread: memoryview) -> tuple[int, memoryview, Any]:
        """Makes the calls of a log up to and with the next step. Returns the
        library's status, the rest of the log, and the step's report."""
        c, handle, calls = ffi.new("drape_step_report *"), self._open(), self._calls
        with handle.lock:
            calls.unread, calls.reads = unread, []
            status = lib.drape_replay(
                handle.world, lib.core_read_bytes, calls.pointer, c
            )
            unread, calls.unread = calls.unread, memoryview(b"")
            reads, calls.reads = calls.reads, None
            self._now = self._clock()  # it may have led elsewhere
            self._follow(reads, status >= 0)
            self._refresh()
            report = self._done(c) if status > 0 else None
            calls.raise_kept()
        return status, unread, report

    def _follow(self, reads: list[memoryview], done: bool) -> None:
        """Brings the scene up to the changes of bodies in what a replay has read,
        of which the last call has failed unless it is done."""
        handle, changed = self._open(), False
        scene, definition, rest = handle.scene, handle.definition, handle.rest
        calls, body = [], ffi.new("int64_t *")
        for at, read in enumerate(reads):
            kind = lib.core_log_piece(ffi.from_buffer(read), len(read), body)
            if kind != lib.CORE_LOG_DATA:
                calls.append((at, kind, body[0]))
        adds = {
            lib.CORE_LOG_CLOTH: ("drape_cloth", lib.CORE_CLOTH),
            lib.CORE_LOG_OBSTACLE: ("drape_obstacle", lib.CORE_OBSTACLE),
        }
        for at, kind, where in calls if done else calls[:-1]:
            if kind == lib.CORE_LOG_REMOVE:
                if (obstacle := where - definition.n_cloths) >= 0:
                    del rest[obstacle]
                lib.core_remove(scene, where)
            elif kind in adds:
                name, sort = adds[kind]
                new = ffi.new(f"{name} *")
                ffi.buffer(new)[:] = reads[at + 1][: ffi.sizeof(name)]
                check_code(lib.core_add(scene, sort, new, ffi.NULL))
                if sort == lib.CORE_OBSTACLE:
                    rest.append(None)  # the log's memory is not its mesh
            changed |= kind != lib.CORE_LOG_CALL
        self._loaded()
        if changed:
            self._changed()
