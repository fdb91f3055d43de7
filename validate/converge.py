# SPDX-License-Identifier: Apache-2.0
"""A strip that falls on a drum and slides off it: whether motion with contact converges.
spec/validation.md §17"""
import math

import numpy as np

from validate.belt import drum
from validate.property import everywhere, slope
from validate.scheme import SCHEMES
from validate.world import NAN, Scene, around

TIMES, ALONG, ACROSS = (0.15, 0.3), 21, 3


def drop(v, how, cell, dt, times):
    """A strip of 0.4 × 0.05 m falls by 20 mm on a drum of 80 mm radius, 30 mm off its
    middle. Returns the places of its material points at the times, m; None: it failed."""
    scene = Scene(v, how, dt)
    scene.material.bend = 1e-4
    m, n = around(0.4 / cell) + 1, around(0.05 / cell) + 1
    strip = scene.sheet(m, n, cell, (-0.17, 0.08 + 0.001 + 0.02, -0.025))
    strip.material.thickness = 1e-3
    drum(scene, 0.08, 0.1, 256, 0.3)
    world, found = scene.world(), []
    at = [k % ALONG * (m - 1) // (ALONG - 1) + m * (k // ALONG * (n - 1) // (ACROSS - 1))
          for k in range(ALONG * ACROSS)]
    for time in times:
        if not world or not world.until(time):
            return None
        found.append(world.x[at])
    return found


def apart(a, b, t):
    """The rms distance of the points of two paths at a time; NaN: none."""
    if a is None or b is None:
        return NAN
    squares = (a[t] - b[t]).ravel()**2
    return math.sqrt(np.cumsum(squares)[-1] / len(a[t]))


def rows(v, what, sizes, paths, fine, times):
    """Errors at several sizes, and their order, at each time."""
    for t, time in enumerate(times):
        p = everywhere(f"{what}; rms error at {time:g} s", "m", 0, NAN)
        q = everywhere(f"{what}; order of the error at {time:g} s; to 1", "1", 1, 0.2, False)
        errors = [apart(path, fine, t) for path in paths]
        for size, error in zip(sizes, errors):
            p.add(size, error)
        q.add(sizes[-1], np.fmin(1, slope(sizes, errors)))
        v.end(p)
        v.end(q)


def converge(v):
    if v.bits == 32:
        return
    times = TIMES[:1 if v.quick else 2]
    bdf2 = SCHEMES[2]
    fine = drop(v, bdf2, 0.01, 1 / 960 if v.quick else 1 / 1920, times)
    steps = 1 / 60, 1 / 120, 1 / 240, 1 / 480
    for how in SCHEMES[:1 if v.quick else None]:
        rows(v, f"{how.name}; by steps", steps,
             [drop(v, how, 0.01, dt, times) for dt in steps], fine, times)
    if v.quick:
        return
    # By cells, from those of half the size of the finest.
    cells = 0.01, 0.005, 0.0025
    fine = drop(v, bdf2, 0.00125, 1 / 240, times)
    rows(v, "bdf2; by cells", cells, [drop(v, bdf2, cell, 1 / 240, times) for cell in cells],
         fine, times)
