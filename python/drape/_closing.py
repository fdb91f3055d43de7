# SPDX-License-Identifier: Apache-2.0
"""What a with statement closes."""

from __future__ import annotations

from types import TracebackType
from typing import TypeVar

T = TypeVar("T", bound="Closing")


class Closing:
    """Is closed at the end of a with statement."""

    def close(self) -> None:
        """Ends it."""
        raise NotImplementedError

    def _leave(self, kind: type[BaseException] | None) -> None:
        """Called at the end, which may be that of an exception of this kind."""
        self.close()

    def __enter__(self: T) -> T:
        """Returns itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes it."""
        self._leave(kind)
