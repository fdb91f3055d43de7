# SPDX-License-Identifier: Apache-2.0
"""Functions of Python that the library calls."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from ._core import ffi
from .errors import Error

Log = Callable[[str], None]
Trace = Callable[[int, str, int, float], None]


class Calls:
    """What a world's calls into Python need: it is their `user` pointer.

    An exception in a function of the caller's does not pass through C: it is
    kept, and raised when the call of the library has returned."""

    def __init__(self, log: Log | None, trace: Trace | None) -> None:
        self.log = log
        self.trace = trace
        self.written = bytearray()
        self.unread = memoryview(b"")
        self.reads: list[memoryview] | None = None  # what was read, if asked for
        self.raised: BaseException | None = None
        self.telling = 0  # the thread in which such a function runs now; 0: in none
        self.pointer = ffi.new_handle(self)

    def keep(self, call: Callable[[], None]) -> None:
        """Calls, and keeps the first exception; after one nothing is called."""
        if self.raised is None:
            self.telling = threading.get_ident()
            try:
                call()
            except BaseException as error:
                self.raised = error
            finally:
                self.telling = 0

    def refuse_inside(self) -> None:
        """Refuses a call of the world by a function that the world calls."""
        if self.telling == threading.get_ident():
            raise Error("a log or trace function may not call its own world")

    def raise_kept(self) -> None:
        """Raises the exception that was kept, and forgets it."""
        error, self.raised = self.raised, None
        if error is not None:
            raise error


@ffi.def_extern()  # type: ignore[untyped-decorator]
def core_log(user: Any, line: Any) -> None:
    """A drape_log."""
    calls: Calls = ffi.from_handle(user)
    log = calls.log
    if log is not None:
        calls.keep(lambda: log(ffi.string(line).decode(errors="replace")))


@ffi.def_extern()  # type: ignore[untyped-decorator]
def core_trace(user: Any, step: int, stage: Any, digest: int, seconds: float) -> None:
    """A drape_trace."""
    calls: Calls = ffi.from_handle(user)
    trace = calls.trace
    if trace is not None:
        name = ffi.string(stage).decode()
        calls.keep(lambda: trace(step, name, digest, seconds))


@ffi.def_extern(error=1)  # type: ignore[untyped-decorator]
def core_write(user: Any, data: Any, size: int) -> int:
    """A drape_write."""
    if size:
        ffi.from_handle(user).written.extend(ffi.buffer(data, size))
    return 0


@ffi.def_extern(error=1)  # type: ignore[untyped-decorator]
def core_read_bytes(user: Any, data: Any, size: int) -> int:
    """A drape_read_bytes."""
    calls: Calls = ffi.from_handle(user)
    if size > len(calls.unread):
        return 1
    if size:
        ffi.buffer(data, size)[:] = calls.unread[:size]
    if calls.reads is not None:
        calls.reads.append(calls.unread[:size])
    calls.unread = calls.unread[size:]
    return 0
