# SPDX-License-Identifier: Apache-2.0
"""Files that appear complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import SceneError


def need_folder(path: Path) -> None:
    """Refuses a file whose folder is not there."""
    if not path.parent.is_dir():
        raise SceneError(f"{path}: there is no folder {path.parent}")


@contextmanager
def beside(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Gives a place beside a file, of the same ending. What is written there
    moves to the file when the block has ended well, and goes if it has not.

    Raises SceneError where the file's folder is not there."""
    target = Path(path)
    need_folder(target)
    part = target.with_name(f".{target.stem}.{os.getpid()}.part{target.suffix.lower()}")
    try:
        yield part
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def write(path: str | os.PathLike[str], data: bytes) -> None:
    """Writes a file whole."""
    with beside(path) as part:
        part.write_bytes(data)
