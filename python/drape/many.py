# SPDX-License-Identifier: Apache-2.0
"""Many worlds side by side, in threads of this process."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor

from .world import Reports, World


def step_many(
    worlds: Iterable[World], n: int = 1, *, threads: int | None = None
) -> list[Reports]:
    """Advances each world by n steps, several worlds at a time.

    A thread takes the next world that nobody has taken and makes its n steps. The
    steps release the GIL, and each world has the bits that it has alone. Worlds may
    differ in scene, size, precision and backend, and each is listed once.

    A small world leaves most of a GPU idle, so worlds on one GPU gain the most.
    `CUDA_DEVICE_MAX_CONNECTIONS=32` in the environment, set before the first world
    of the process is made, lets more of their streams run at once. All worlds are on
    the device that is current in the calling thread.

    Args:
        worlds: the worlds, which no other thread uses meanwhile
        n: steps of each
        threads: how many threads at most; None: one a processor

    Returns:
        the reports of each world, in the order of the worlds

    Raises:
        Error: a world's step failed or diverged: what the first such world's `step`
            raised. All other worlds have made their n steps; `World.report` tells
            how far the others that failed have come.
    """
    all_worlds = list(worlds)
    if len({id(world) for world in all_worlds}) < len(all_worlds):
        raise ValueError("worlds: one of them is listed twice")
    if threads is not None and threads < 1:
        raise ValueError(f"threads: expected 1 or more, got {threads}")
    if not all_worlds:
        return []
    most = min(threads or len(os.sched_getaffinity(0)), len(all_worlds))
    with ThreadPoolExecutor(most) as pool:
        futures = [pool.submit(world.step, n) for world in all_worlds]
    return [future.result() for future in futures]
