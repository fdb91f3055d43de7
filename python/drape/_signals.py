# SPDX-License-Identifier: Apache-2.0
"""Signals, as that of Ctrl-C, that come while a world is being changed.

Python calls the handler of a signal between any two of its instructions. The
handler may raise an exception, as Ctrl-C's does, between the library's step and
what this package writes down of it: the step would be lost."""

from __future__ import annotations

import _signal  # `signal` makes enumerations of what this returns: 20 µs a block
import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

# Those whose handlers a program may let raise an exception.
SIGNALS = (
    *(signal.SIGINT, signal.SIGTERM, signal.SIGHUP),
    *(signal.SIGALRM, signal.SIGUSR1, signal.SIGUSR2),
)


class Held:
    """Within its block, handlers of signals wait for `deliver` and for the end of
    the block. Blocks may be nested. Python calls handlers in the main thread only,
    so that a block in another thread has nothing to do."""

    def __init__(self) -> None:
        self.handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self.came: list[tuple[int, FrameType | None]] = []

    def __enter__(self) -> Held:
        if threading.get_ident() != threading.main_thread().ident:
            return self
        try:
            for number in SIGNALS:
                handler = _signal.getsignal(number)
                if callable(handler):
                    self.handlers[number] = handler
                    _signal.signal(number, self._note)
        except BaseException:  # a handler's that was called before it was replaced
            self._put_back()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._put_back()
        self.deliver()

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.came.append((number, frame))

    def _put_back(self) -> None:
        try:
            for number, handler in self.handlers.items():
                _signal.signal(number, handler)
        except BaseException:  # one that is back was called, and has raised this
            self._put_back()
            raise

    def deliver(self) -> None:
        """Calls the handlers of the signals that have come. Call it where all that
        was done is written down: an exception of a handler is raised here."""
        if self.came:
            number, frame = self.came.pop(0)
            try:
                self.handlers[number](number, frame)
            finally:
                self.deliver()
