# SPDX-License-Identifier: Apache-2.0
"""Point caches (.pc2), which Blender's Mesh Cache modifier reads."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drape._closing import Closing


class PointCache(Closing):
    """Writes a point cache, one sample a frame: `with PointCache(…) as cache`."""

    def __init__(self, path: Path, points: int, samples: int) -> None:
        """Opens a file for so many points and samples."""
        self._shape = points, 3
        self._file = open(path, "wb")
        head = b"POINTCACHE2\0", 1, points, 0.0, 1.0, samples
        self._file.write(struct.pack("<12siiffi", *head))

    def close(self) -> None:
        """Closes the file; again, too."""
        self._file.close()

    def add(self, x: NDArray[Any]) -> None:
        """Appends positions [points, 3], m."""
        if x.shape != self._shape:
            raise ValueError(f"expected {self._shape}, not {x.shape}")
        self._file.write(np.ascontiguousarray(x, "<f4").tobytes())
        self._file.flush()  # so that it can be read while it is written
