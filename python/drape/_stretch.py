# SPDX-License-Identifier: Apache-2.0
"""Warns of cloths that are stretched beyond what fabrics bear, as the tool does at the
end of a run (app/write/stretch.c): springs do not tear, and such steps are clean."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from ._define import Handle
from .errors import check_code, warn

TWICE = 2
APART = 10  # steps between two looks, which thus cost little beside the steps


class Stretch:
    """What was seen of a world's cloths so far."""

    def __init__(self) -> None:
        """Nothing."""
        self._next = 0
        self._told: set[str] = set()

    def look(
        self,
        step: int,
        handle: Handle,
        read: Callable[[], tuple[NDArray[np.float64], Any]],
        triangles: NDArray[np.int32],
        bodies: Sequence[Any],
    ) -> None:
        """Looks at what `read` gives after a step, once in ten steps, and warns of each
        cloth with a side of a cell that is more than twice as long as at rest, once."""
        if self._next - APART < step < self._next:
            return
        self._next = step + APART
        cloths = [body for body in bodies if body.kind == "cloth"]
        most = ffi.new("double[]", len(cloths))
        x = ffi.cast("double (*)[3]", (kept := read()[0]).ctypes.data)
        tri = ffi.cast("int32_t (*)[3]", triangles.ctypes.data)
        check_code(lib.core_stretch(handle.scene, handle.made, x, tri, most))
        del kept
        for body, far in zip(cloths, most, strict=True):
            if far > TWICE and body.name not in self._told:
                self._told.add(body.name)
                warn(
                    f"{body.name}: note: after step {step} it is stretched to "
                    f"{far:.3g} times its length, where fabrics tear; a stiffer "
                    "material or its limit of strain holds it"
                )
