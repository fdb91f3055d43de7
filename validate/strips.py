# SPDX-License-Identifier: Apache-2.0
"""Strips that bend by their weight: the heavy cantilever of Romero et al. 2021, lateral
buckling of a strip on edge, and bending with twist. spec/validation.md §2, §10, §11"""
import math
from math import cos, sin

import numpy as np

from validate.property import SIZES, Property, measure
from validate.theory import Rod, elastica
from validate.world import G, NAN, around, lay, rest, sheet, total

BEND, WEIGHT = 1e-4, 0.2 * G  # N·m, N/m²


def length_of(gamma):
    return math.cbrt(gamma * BEND / WEIGHT)


def ribbon(v, gamma, cells, n):
    """Drop over distance of the tip of a strip of `cells` cells of length and n particles
    of width: two rows are pinned, so the clamp is half a cell before the second of them
    (cloth.md §7). Measured in the middle of the width."""
    length = length_of(gamma)
    h = length / (cells - 0.5)
    s = sheet(v, cells + 1, n, h)
    s.material.bend = BEND
    lay(s)
    for j in range(n):
        s.pin(0, j)
        s.pin(1, j)
    if not rest(s, (1e-7 if v.bits == 64 else 1e-5) * length):
        return NAN
    tip = s.x[cells + (cells + 1) * (n // 2)]
    return -tip[1] / (tip[0] - h / 2)


def bias(v, gamma, cells):
    """The same of a strip along the diagonal of the cells, as wide as it is long, whose
    borders are stairs. `last` is the number of the row across of the tip and `first` that
    of the last one that is pinned, h/√2 apart. Triples along the diagonal, two thirds of
    the moment, reach over two rows and those along the axes over one: the deflection of a
    line of both with a load at its end is that of a beam clamped 0.828 rows before
    `first`. The plane's stiffness keeps the strip from bending across as well. It is less
    for strips that curve more, as a curved grid locks: spec/validation.md §2."""
    before = 0.828
    length = length_of(gamma)
    rows = 2 * around(cells * math.sqrt(0.5))
    wide = rows // 2
    first = wide + 4
    last = first + rows
    last += last % 2
    h = math.sqrt(2) * length / (last - first + before)
    side = (last + wide) // 2 + 1
    s = sheet(v, side, side, h)
    s.material.bend = BEND
    s.material.stretch, s.material.shear = 1e5 / gamma, 3e4 / gamma
    lay(s)
    row = s.i + s.j
    s.hole[:] = (abs(s.i - s.j) > wide) | (row > last) | (row < first - 4)
    for p in np.flatnonzero((s.hole == 0) & (row <= first) & (row >= first - 2)):
        s.pin(p % side, p // side)
    if not rest(s, (1e-7 if v.bits == 64 else 1e-5) * length):
        return NAN
    tip = s.x[last // 2 * (side + 1)]
    along = (tip[0] - tip[2]) * math.sqrt(0.5)
    return -tip[1] / (along - (first - before) * h * math.sqrt(0.5))


def cantilever(v):
    gammas = 1, 3, 10, 30, 100
    warp, other = (12, 25, 50, 100), (16, 25, 36, 50)
    rows = [("ribbon in warp", 0.01, gammas, warp,
             lambda gamma, n: ribbon(v, gamma, n, 2)),
            ("bias strip", 0.08 if v.quick else 0.03, (10,) if v.quick else (1, 10, 100),
             other, lambda gamma, n: bias(v, gamma, n))]
    if not v.quick and v.bits == 64:
        rows.append(("sheet in warp", 0.01, (1, 100), other[:3],
                     lambda gamma, n: ribbon(v, gamma, n, 4 * n + 1)))
    for kind, bar, some, cells, found in rows:
        for gamma in some:
            length = length_of(gamma)
            p = Property(f"{kind}; Γ = {gamma:g}", "H/W", elastica(gamma), bar, True,
                         True, length / 50)
            for n in cells[:2 if v.quick else SIZES]:
                p.add(length / n, found(gamma, n))
            v.end(p)


# A slender strip that bends and twists by its weight: clamped at one end with its axis
# level, rolled about it, 0 lies flat; the other end hangs free.

SLENDER, YOUNG, THIRD = 20, 910, 1 / 3  # length over width; N/m, along the warp: §4;
# Poisson's ratio for bending
ACROSS = 2, 3, 4, 6  # cells of width


def rod(gamma, roll):
    """By how much the middle of its free end is lower than the clamp, and how far it is
    to the side, over the length; NaN: no equilibrium was found. A strip whose sides are
    free bends with D (1 − ν²) a width and is twisted with 2 D (1 − ν); in its plane it
    bends as a beam as deep as it is wide."""
    wide, soft = length_of(gamma) / SLENDER, 1 - THIRD * THIRD
    tip = Rod(YOUNG * wide * wide / 12 / (soft * BEND), 2 * (1 - THIRD) / soft, roll,
              gamma / soft).tip()
    return (-tip[1], abs(tip[2])) if tip else (NAN, NAN)


def rolled(v, gamma, roll, across):
    """The same of a sheet with so many cells of width. Two columns are pinned, so the
    clamp is half a cell before the second one. The sheet stands in the plane of x and y,
    and gravity is turned."""
    length, along = length_of(gamma), SLENDER * across
    down = 0, -sin(roll), -cos(roll)
    h = length / (along - 0.5)
    s = sheet(v, along + 1, across + 1, h)
    s.material.bend = BEND
    s.scene.settings.max_iterations = 20000
    s.scene.settings.gravity = [G * one for one in down]
    for j in range(across + 1):
        s.pin(0, j)
        s.pin(1, j)
    start = s.x.copy()
    if not rest(s, (1e-8 if v.bits == 64 else 1e-5) * length):
        return NAN, NAN
    mean = total((s.x[along::along + 1] - start[along::along + 1]) / (across + 1))
    return ((mean[1] * down[1] + mean[2] * down[2]) / length,
            abs(mean[1] * down[2] - mean[2] * down[1]) / length)


def critical(found):
    """The critical Γ by Southwell's method: a small lean grows as Γ / (1 − Γ²/Γc²), here
    between two Γ below it, from the upright by a thousandth."""
    a, b = 8, 10
    low, high = (found(gamma, math.pi / 2 - 1e-3)[1] / gamma for gamma in (a, b))
    f = low / high
    return math.sqrt((b * b - f * a * a) / (1 - f)) if f < 1 else NAN


def buckling(v):
    if v.bits == 32:
        return
    p = Property("critical Γ of a strip on edge", "1", critical(rod),
                 0.25 if v.quick else 0.05, True, True)
    for across in ACROSS[:2 if v.quick else SIZES]:
        p.add(length_of(10) / (20 * across),
              critical(lambda gamma, roll, n=across: rolled(v, gamma, roll, n)))
    v.end(p)


def bendtwist(v):
    if v.bits == 32:
        return
    for degrees in (30, 60)[:1 if v.quick else 2]:
        roll = degrees * math.pi / 180
        rows = [Property(f"strip rolled by {degrees} degrees; Γ = 5; {what} of the tip",
                         "of L", due, 0.1 if v.quick else 0.05, degrees == 30, True)
                for what, due in zip(("drop", "way to the side"), rod(5, roll))]
        sizes = {length_of(5) / (20 * n): n for n in ACROSS[:2 if v.quick else SIZES]}
        measure(v, rows, sizes, lambda size: rolled(v, 5, roll, sizes[size]))
