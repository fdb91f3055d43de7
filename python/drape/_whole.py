# SPDX-License-Identifier: Apache-2.0
"""Files that appear complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def beside(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Gives a place beside a file, of the same ending. What is written there
    moves to the file when the block has ended well, and goes if it has not."""
    target = Path(path)
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
