# SPDX-License-Identifier: Apache-2.0
"""What a checkpoint tells of a world that no call of the library does
(ref/world/checkpoint.c, ref/control/unpack.c)."""

from __future__ import annotations

import struct
from typing import Any

from ._core import ffi

# What a checkpoint begins with. Number 5 is that of the step, number 8 the time,
# and the last six are the wind.
HEADER = struct.Struct("=8s2I2Qq2qd2HI6H4x6d")
# A world that nobody has changed has this magic. The header of another is followed
# by the size of the changes, and these come after gravity.
UNCHANGED = b"drape-7\0"
CHANGES = struct.Struct("=qQ3d")
PINS = struct.Struct("=q")


def clock(checkpoint: bytes) -> tuple[int, float]:
    """Returns the steps done and the time, s."""
    fields = HEADER.unpack_from(checkpoint)
    return fields[5], fields[8]


def wind(checkpoint: bytes) -> tuple[list[float], float, float, float]:
    """Returns the fields of a drape_wind."""
    fields = HEADER.unpack_from(checkpoint)[-6:]
    return list(fields[:3]), *fields[3:]


def materials(checkpoint: bytes, cloths: int) -> list[Any]:
    """Returns the drape_material of each cloth; empty: all are as defined."""
    if (
        checkpoint.startswith(UNCHANGED)
        or not CHANGES.unpack_from(checkpoint, HEADER.size)[0]
    ):
        return []
    at, found = HEADER.size + CHANGES.size, []
    for _ in range(cloths):
        found.append(ffi.new("drape_material *"))
        size = ffi.sizeof("drape_material")
        ffi.buffer(found[-1])[:] = checkpoint[at : at + size]
        (pins,) = PINS.unpack_from(checkpoint, at + size)
        # the particles of the pins follow, two a word
        at += size + PINS.size + 8 * ((max(pins, 0) + 1) // 2)
    return found
