# SPDX-License-Identifier: Apache-2.0
"""Exceptions: each carries the text that says what was wrong and where."""

from __future__ import annotations

import importlib
import os
import warnings
from typing import Any

from . import _whose  # noqa: F401  PyPI's drape may have taken drape/__init__.py
from ._core import ffi, lib
from .reports import Status


class Error(Exception):
    """A call of drape that failed; the text says what and where.

    Attributes:
        status: the library's status, where a call of it has failed
    """

    status: Status | None = None


class SceneError(Error, ValueError):
    """A scene, an array or an argument that is refused."""


class OutOfMemoryError(Error, MemoryError):
    """An allocator returned nothing."""


class DeviceError(Error, RuntimeError):
    """This build or machine lacks the backend, or the device has failed."""


class CheckpointError(Error, ValueError):
    """A checkpoint that is damaged or of another scene, precision or format."""


class DivergedError(Error, ArithmeticError):
    """A step was given up, as energy appeared from nothing or a value was not
    finite. The world's state and time are those before that step."""


KINDS: dict[Status, type[Error]] = {
    Status.EARG: SceneError,
    Status.EDATA: SceneError,
    Status.ESTART: SceneError,
    Status.ENOMEM: OutOfMemoryError,
    Status.EDEVICE: DeviceError,
    Status.EMATCH: CheckpointError,
}


def check(status: int, what: str) -> int:
    """Returns a status that is no error; raises what a negative one means."""
    if status >= 0:
        return status
    text = ffi.string(lib.drape_status_text(status)).decode()
    error = KINDS.get(Status(status), Error)(f"{what}: {text}")
    error.status = Status(status)
    raise error


def need(module: str, what: str, *packages: str) -> Any:
    """Returns a module that not every drape has with it; an Error that says which
    packages `what` needs, where they are not installed."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        some = "the package" if len(packages) == 1 else "the packages"
        raise Error(
            f"{what} needs {some} {' and '.join(packages)} ({error}): "
            f"pip install {' '.join(packages)}"
        ) from error


def warn(text: str) -> None:
    """Warns the caller outside of this package."""
    warnings.warn(text, stacklevel=_outside())


def check_code(code: int, status: int = 0) -> None:
    """Raises what a call of the tool's code has said before it failed, and
    warns of what it has noted. Call it in the thread that made the call. The
    library's status, if that is why the call failed, decides the exception."""
    for note in ffi.string(lib.core_notes()).decode(errors="replace").splitlines():
        warn(note)
    text = ffi.string(lib.core_error()).decode(errors="replace")
    if code and status < 0:
        error = KINDS.get(Status(status), SceneError)(text)
        error.status = Status(status)
        raise error
    if code == 2:
        raise SceneError(text)
    if code:
        raise Error(text)


def _outside() -> int:
    """Returns the stack level of the caller outside of this package."""
    import sys

    level, frame = 1, sys._getframe(1)
    here = os.path.dirname(__file__)
    while frame.f_back and os.path.dirname(frame.f_code.co_filename) == here:
        frame = frame.f_back
        level += 1
    return level
