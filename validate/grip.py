# SPDX-License-Identifier: Apache-2.0
"""Cloth between two bodies. spec/validation.md §14"""
from dataclasses import dataclass, replace

import numpy as np
from drape._core import ffi, lib

from validate.property import everywhere, measure
from validate.scheme import PLAIN, Scheme, schemes
from validate.world import G, NAN, Scene, around, total

GAPS = 0.1, 0.3, 0.5, 0.7, 0.9, 0.95
STEPS = 1 / 30, 1 / 60, 1 / 240, 1 / 480
BOX = ((0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7),
       (2, 7, 3), (0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6))


def hang(scene, m, n, h, top):
    """Hangs a sheet in the plane x = 0, the upper border at this height."""
    s = scene.sheet(m, n, h)
    s.x[:, 0] = 0
    s.x[:, 1] = top - h * s.j
    s.x[:, 2] = h * s.i - h * (m - 1) / 2
    return s


def pads(scene, apart, half, height, friction):
    """Two boxes on the sides of the plane x = 0, of this half extent along y and z around
    a height."""
    for side in -1, 1:
        low, high = sorted((side * apart / 2, side * 0.1))
        lo, hi = (low, height - half[0], -half[1]), (high, height + half[0], half[1])
        scene.body([[(hi if k >> c & 1 else lo)[c] for c in range(3)] for k in range(8)],
                   BOX, friction)


@dataclass
class Jaws:
    """A strip of 50 × 200 mm that hangs, of which jaws hold the upper 50 mm. gap: between
    them, of two thicknesses; closing: they close on a strip that is pinned and then let
    go."""
    closing: bool
    friction: float
    time: float
    gap: float = 0
    cell: float = 0.01
    dt: float = 1 / 60
    how: Scheme = PLAIN

    def run(self, v):
        """How far the strip falls in the time, m, and its speed then."""
        span, begin = 0.25, 0
        m, n = around(0.05 / self.cell) + 1, around(0.2 / self.cell) + 1
        scene = Scene(v, self.how, self.dt)
        s = hang(scene, m, n, self.cell, 0.05)
        wide = 2 * s.thickness
        pads(scene, wide * (1.1 if self.closing else self.gap), (0.05, 0.1), 0.05,
             self.friction)
        if self.closing:
            begin = 0.3
            for side, body in zip((1, -1), scene.bodies):
                speed = side * (1.1 - self.gap) * wide / 2 / span
                body.motion = scene.motion(0, span, 0, (speed, 0, 0))
            for i in range(m):
                s.pin(i, 0)
        world = scene.world()
        if not world or not world.until(begin) or self.closing and lib.drape_set_pins(
                world.made, 0, 0, ffi.NULL, ffi.NULL) != 0:
            return NAN, NAN
        start = world.mean(s, world.x)
        if not world.until(begin + self.time):
            return NAN, NAN
        return (abs(world.mean(s, world.x)[1] - start[1]),
                abs(world.mean(s, world.u)[1]))


def jaws_rows(v, jaws, sizes, cells):
    """Rows by cells or by steps, of all gaps; one more for the speed."""
    kind = "jaws that close" if jaws.closing else "jaws"
    by = "by cells" if cells else "by steps"
    fastest = dict.fromkeys(sizes, 0)
    for gap in GAPS:
        p = everywhere(f"{kind}; {by}; {gap:g} of two thicknesses apart; {jaws.how.name}; "
                       f"way in {jaws.time:g} s", "m", 0, 1e-3, v.quick)
        for size in sizes:
            way, speed = replace(jaws, gap=gap,
                                 **{"cell" if cells else "dt": size}).run(v)
            p.add(size, way)
            if not speed <= fastest[size]:
                fastest[size] = speed
        v.end(p)
    measure(v, [everywhere(f"{kind}; {by}; {jaws.how.name}; largest speed at the end at any "
                           "distance", "m/s", 0, 1e-3, v.quick)], sizes, fastest.get)


def pinch(v, dt):
    """How far a towel of 200 mm sinks that hangs from two small pads, in the second
    second, as its free corners sink first."""
    scene = Scene(v, PLAIN, dt)
    s = hang(scene, 41, 41, 0.005, 0.3)
    pads(scene, 0.002, (0.015, 0.04), 0.28, 1)
    world = scene.world()
    if not world or not world.until(1):
        return NAN
    start = world.mean(s, world.x)
    return abs(world.mean(s, world.x)[1] - start[1]) if world.until(2) else NAN


def plates(v, friction, cell, how, dt):
    """A strip that is pulled at 20 mm/s from between a floor and a heavy sheet, whose far
    border is held. Returns the force over that of friction on both sides: the force is
    that of the strain near the drawn end; and what presses the two sides over twice the
    sheet's weight, less what its held border bears."""
    pull, press, stiff, wide, last = 0, 0, 1e4, 0.05, 20
    m, n = around(0.2 / cell) + 1, around(wide / cell) + 1
    scene = Scene(v, how, dt)
    scene.material.stretch, scene.material.shear = stiff, 0.3 * stiff
    scene.material.friction = friction
    thick = min(scene.material.thickness, cell / 2)
    strip = scene.sheet(m, n, cell, (-0.1, thick, -0.025))
    scene.material.density, scene.material.bend = 10, 1e-2
    weight = scene.sheet((m + 1) // 2, n, cell, (-0.1037, 2 * thick, -0.0229))
    scene.floor(friction)
    motion = scene.motion(0.3, 1.5, 0, (0.02, 0, 0))
    for j in range(n):
        strip.pin(m - 1, j, motion)
        weight.pin(0, j)
    world = scene.world()
    if not world or not world.until(1):
        return NAN, NAN
    a, b = around(0.15 / cell), around(0.19 / cell)
    for _ in range(last):
        found = world.contacts() if world.goes() else None
        if not found:
            return NAN, NAN
        x = world.x[:strip.count, 0].reshape(n, m)
        strain = total(((x[:, b] - x[:, a]) / ((b - a) * cell) - 1) / n)
        # Young's modulus along the warp: §4
        pull += (1 - 0.09) * stiff * strain * wide / last
        _, impulse, length = found
        press += (abs(impulse[1][1]) + abs(impulse[2][1])) / length / last
    # The border bears half of the first column of cells.
    due = 2 * G * weight.mass * (1 - 0.5 / (weight.m - 1))
    return np.float64(pull) / (friction * press), press / due


def grip(v):
    if v.quick and v.bits == 32:
        return
    for closing in False, True:
        jaws = Jaws(closing, 0.3 if closing else 1, 0.2 if v.quick else 0.5)
        jaws_rows(v, jaws, (0.01, 0.005, 0.002)[:1 if v.quick else 3 if v.bits == 64 else 2],
                  True)
        for how in [] if v.quick else schemes(v):
            jaws_rows(v, replace(jaws, how=how), STEPS[:4 if how is PLAIN else 2], False)
    if v.quick:
        return
    measure(v, [everywhere("a towel hangs from small pads; way in the second s", "m", 0,
                           1e-3, False)], STEPS[1:3], lambda dt: pinch(v, dt))
    for friction in 0.1, 0.3, 0.6:
        for how in schemes(v)[:None if friction == 0.3 else 1]:
            title = f"pulled from under a weight; friction {friction:g}; {how.name}; "
            measure(v, [everywhere(f"{title}pull over friction of both sides", "1", 1, 0.02,
                                   False),
                        everywhere(f"{title}load of both sides over the weight's", "1", 1,
                                   0.05, False)], STEPS[1:3],
                    lambda dt, mu=friction, how=how: plates(v, mu, 0.01, how, dt))
