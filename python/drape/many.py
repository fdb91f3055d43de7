# SPDX-License-Identifier: Apache-2.0
"""Many worlds side by side."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack

from ._core import ffi, lib
from ._signals import Held
from .errors import Error
from .scene import whole
from .world import Reports, World

# s that a call of the library is to take, between which Ctrl-C is heard.
MOMENT = 0.2


def step_many(
    worlds: Iterable[World], n: int = 1, *, threads: int | None = None
) -> list[Reports]:
    """Advances each world by n steps, several worlds at a time.

    Small worlds on one GPU are advanced together: what many of them launch is one
    launch, so 256 worlds of 2,500 triangles make twenty to thirty times as many
    steps a second as one after another. All other worlds are stepped side by side
    in threads. The steps release the GIL, and each world has the bits that it has
    alone. Worlds may differ in scene, size, precision and backend, and each is
    listed once. All are on the device that is current in the calling thread.

    Worlds with a `log` or a `trace`, and worlds that are recorded, are always
    stepped in threads.

    Ctrl-C is heard between steps, a few tenths of a second after it came or when
    the longest step has ended. Each world is then whole, after steps of a number of
    its own, and its `World.reports` has what this call would have returned.

    Args:
        worlds: the worlds, which no other thread uses meanwhile
        n: steps of each
        threads: how many threads at most; None: one a processor

    Returns:
        the reports of each world, in the order of the worlds

    Raises:
        TypeError: one of the worlds is not a World
        Error: a world's step failed or diverged: what the first such world's `step`
            raised. All other worlds have made their n steps; `World.report` tells
            how far the others that failed have come.
    """
    all_worlds = _listed(worlds)
    n = whole(n, "step")
    if threads is not None and whole(threads, "threads") < 1:
        raise ValueError(f"threads: expected 1 or more, got {threads}")
    if n < 0:
        raise ValueError(f"step: {n}: expected 0 or more")
    plain = [world for world in all_worlds if world._is_plain]
    others = [world for world in all_worlds if not world._is_plain]
    most = threads or len(os.sched_getaffinity(0))
    stop = threading.Event()

    def between() -> None:
        if stop.is_set():
            raise CancelledError("step_many was interrupted")

    with Held() as held, ThreadPoolExecutor(max(1, min(most, len(others)))) as pool:
        for world in all_worlds:
            world._begin()
        ends = {id(each): pool.submit(each._steps, n, between) for each in others}
        try:
            ends.update(_together(plain, n, most, held.deliver))
            while wait(ends.values(), MOMENT).not_done:
                held.deliver()
        except BaseException:
            stop.set()
            raise
    return [ends[id(world)].result() for world in all_worlds]


def _listed(worlds: Iterable[World]) -> list[World]:
    """Returns the worlds as a list, in which each is a world and is there once."""
    if isinstance(worlds, World) or not isinstance(worlds, Iterable):
        raise TypeError(
            f"worlds: expected worlds, as in step_many([world], n), not {worlds!r}"
        )
    found = list(worlds)
    for k, each in enumerate(found):
        if not isinstance(each, World):
            raise TypeError(f"worlds[{k}]: expected a drape.World, not {each!r}")
    if len({id(world) for world in found}) < len(found):
        raise ValueError("worlds: one of them is listed twice")
    return found


def _together(
    worlds: Sequence[World], n: int, threads: int, between: Callable[[], object]
) -> dict[int, Future[Reports]]:
    """Advances worlds by few calls of the library, with a call between each two,
    which may raise an exception. Returns how each ended, by its id."""
    ends: dict[int, Future[Reports]] = {id(world): Future() for world in worlds}
    left, steps = n, 1
    going = list(worlds)
    while going and left:
        between()
        steps = min(steps, left)
        began = time.monotonic()
        going = _advance(going, steps, threads, ends)
        left -= steps
        share = MOMENT / max(time.monotonic() - began, 1e-6)
        steps = max(1, int(steps * min(share, 2)))
    for world in going:
        ends[id(world)].set_result(world._reports)
    return ends


def _advance(
    worlds: list[World], n: int, threads: int, ends: dict[int, Future[Reports]]
) -> list[World]:
    """Advances worlds by one call of the library. Returns those that go on; the
    others have ended with an exception."""
    made = ffi.new("drape_step_report[]", max(1, len(worlds) * n))
    status = ffi.new("int[]", [1] * len(worlds))  # 1: not begun
    with ExitStack() as guards:
        for world in worlds:
            guards.enter_context(world._guard)
        handles = ffi.new("drape_world *[]", [world._world for world in worlds])
        code = lib.drape_step_many(handles, len(worlds), n, threads, made, status)
    going = []
    for k, world in enumerate(worlds):
        reports = [made[k * n + j] for j in range(n)]
        try:
            world._take(reports, code if status[k] > 0 else status[k])
            going.append(world)
        except Error as error:
            ends[id(world)].set_exception(error)
    return going
