# SPDX-License-Identifier: Apache-2.0
"""What a page of `drape view` takes to show a frame, without a browser: the time in
which it hands the positions, and the colours of strain, to viser.

usage: viewer.py [TRIANGLES…]; default: 20000 500000
"""

from __future__ import annotations

import statistics
import sys
import time

import numpy as np

import drape
from drape.export.run import make_cloth
from drape.viewer.page import Page
from drape.viewer.source import Meshes

FRAMES = 30


def sheet(triangles: int) -> Meshes:
    """A square cloth of about so many triangles, with two frames."""
    n = round((triangles / 2) ** 0.5) + 1
    grid = np.arange(n * n)
    x = np.stack([grid % n, grid // n, 0 * grid], 1) / (n - 1.0)
    at = grid.reshape(n, n)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    halves = np.stack([a, b, c], 2), np.stack([a, c, d], 2)
    tri = np.concatenate([half.reshape(-1, 3) for half in halves]).astype(np.int32)
    frames = np.stack([x, 1.01 * x])
    source = Meshes([drape.Mesh("sheet", x, tri, frames, 1 / 60)], "sheet")
    source.bodies = [make_cloth("sheet", tri, 0, (n, n), (1.0, 1.0))]
    return source


def main() -> None:
    """Prints a row a size: the median of FRAMES frames, ms."""
    print("triangles, ms a frame, ms with strain")
    for triangles in [int(each) for each in sys.argv[1:]] or [20000, 500000]:
        source = sheet(triangles)
        page = Page(source, "127.0.0.1", 0, play=False)
        row = []
        for colour in ("cloth", "strain"):
            page.colour.value = colour
            took = []
            for k in range(FRAMES):
                page.frame.value = k % 2
                start = time.perf_counter()
                page._show(False)
                took.append(time.perf_counter() - start)
            row.append(1000 * statistics.median(took))
        page.close()
        print(f"{len(source.bodies[0].faces)}, {row[0]:.1f}, {row[1]:.1f}", flush=True)


if __name__ == "__main__":
    main()
