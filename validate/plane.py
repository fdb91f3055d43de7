# SPDX-License-Identifier: Apache-2.0
"""Sheets in their plane and bent to a cylinder: energies of uniform strains, and strips
and sheets that hang. spec/validation.md §3, §4, §8"""
import math
from math import cos, sin

import numpy as np

from validate.property import SIZES, Property, everywhere, measure
from validate.world import G, NAN, around, distance, energy_of, rest, sheet

CELLS = 0.02, 0.01, 0.005, 0.0025


# A cylinder

BOW, BEND = 10, 1e-4  # 1/m, N·m


def bent(v, m, n, h, way):
    """The energy of a sheet of m × n particles bent in the direction `way`. Its arc is
    kept and its plane's stiffness next to nothing, so that it is bending."""
    s = sheet(v, m, n, h)
    s.material.bend, s.material.stretch, s.material.shear = BEND, 1e-9, 3e-10
    c, d = cos(way), sin(way)
    for p in range(m * n):
        a, b = h * (p % m), h * (p // m)
        along, across = c * a + d * b, c * b - d * a
        s.x[p] = (sin(BOW * along) / BOW, across, (1 - cos(BOW * along)) / BOW)
    return energy_of(s)


def inner(v, h, way, n=7):
    """The energy by area of one cell inside, over ½ D κ²: every cell of a cylinder is
    like any other but for a turn, so borders and corners cancel in this difference of
    four sheets."""
    energy = (bent(v, n + 1, n + 1, h, way) - bent(v, n + 1, n, h, way) -
              bent(v, n, n + 1, h, way) + bent(v, n, n, h, way))
    return energy / (BEND * BOW * BOW / 2 * h * h)


def cylinder(v):
    for degrees in 0, 15, 22.5, 30, 45, 60, 90, 135:
        way = degrees * math.pi / 180
        name = f"bent at {degrees:g} degrees to warp"
        if v.bits == 64:
            p = Property(name, "of ½Dκ²", 1, 0.01, True, True, 0.05 / BOW)

            def found(h, way=way):
                return inner(v, h, way)
        else:  # the difference of four sheets would lose all of 24 bits
            p = Property(f"{name}; whole sheet over that of binary64", "of ½Dκ²", 1,
                         0.02, True, True, 0.05 / BOW)

            def found(h, way=way):
                one = bent(v, 20, 20, h, way)
                v.bits = 64
                other = bent(v, 20, 20, h, way)
                v.bits = 32
                return one / other
        measure(v, [p], [turn / BOW for turn in (0.1, 0.05, 0.025, 0.0125)], found)


# Uniform strains

def density(v, h, f):
    """Energy by area of a sheet of 0.1 m in a uniform deformation f."""
    n = around(0.1 / h)
    s = sheet(v, n + 1, n + 1, h)
    a, b = h * s.i, h * s.j
    s.x[:, 0] = f[0][0] * a + f[0][1] * b
    s.x[:, 1] = f[1][0] * a + f[1][1] * b
    return energy_of(s) / (n * h * n * h)


def stretched(v, h, way, along, across):
    """Energy by area where the sheet is `along` longer in the direction `way` and
    `across` wider."""
    c, s = cos(way), sin(way)
    turned = (along - across) * c * s
    return density(v, h, ((1 + along * c * c + across * s * s, turned),
                          (turned, 1 + along * s * s + across * c * c)))


def moduli(v, h, way, e):
    """Young's modulus and Poisson's ratio of W = ½ (a ε² + 2 b ε ν' + c ν'²), ν' the
    strain across, where ν' is free. Strains of both signs cancel the cubic terms."""
    w = [0, 0, 0]
    for d in -e, e:
        for k, strains in enumerate(((d, 0), (0, d), (d, d))):
            w[k] += stretched(v, h, way, *strains) / (e * e)
    a, c, b = w[0], w[1], (w[2] - w[0] - w[1]) / 2
    return a - b * b / c, b / c


def moduli_due(way):
    """What §4 of cloth.md gives in a direction: with C11 = C22 = stretch, C12 = C66 =
    shear, as a plane's tensor turned by the angle."""
    c, s = cos(way)**2, sin(way)**2
    c11, c66 = 1000, 300
    a = c11 * (c * c + s * s) + 6 * c66 * c * s
    b = (c11 - 3 * c66) * 2 * c * s + c66
    return a - b * b / a, b / a


def plane(v):
    e = 1e-3 if v.bits == 64 else 1e-2
    cells = CELLS[:2 if v.quick else SIZES]
    for name, degrees in ("warp", 0), ("weft", 90), ("bias", 45):
        way = degrees * math.pi / 180
        due = moduli_due(way)
        found = {h: moduli(v, h, way, e) for h in cells}
        for k, what in enumerate(("Young's modulus", "Poisson's ratio")):
            p = everywhere(f"{what} in {name}; strain {100 * e:g} %",
                           "1" if k else "N/m", due[k], 0.005)
            p.share = True
            measure(v, [p], cells, lambda h, k=k, all_=found: all_[h][k])
    for angle in (0.001, 0.01, 0.1)[0 if v.bits == 64 else 1:]:
        p = everywhere(f"shear modulus at {100 * angle:g} %", "N/m", 300,
                       0.005 if angle == 0.001 else 0.02)
        p.share = True
        measure(v, [p], cells, lambda h, angle=angle: 2 * density(
            v, h, ((1, angle), (0, 1))) / (angle * angle))


# Strips that hang

LENGTH, WIDE, WEIGHT = 0.3, 0.1, 0.3 * G


def hangs_by_warp(v, h):
    """Young's modulus and Poisson's ratio of a strip cut along the warp. Halfway between
    two rows the tension is the weight below, to the bit of the model."""
    m, n = around(WIDE / h) + 1, around(LENGTH / h) + 1
    s = sheet(v, m, n, h)
    s.material.density = WEIGHT / G
    for i in range(m):
        s.pin(i, 0)
    if not rest(s, 1e-9):
        return NAN, NAN
    j, i, d = n // 2, m // 2, m // 4
    load = WEIGHT * (LENGTH - j * h)  # mean of the rows j ± d
    x = s.x
    along = distance(x[i + m * (j - d)], x[i + m * (j + d)]) / (2 * d * h) - 1
    across = distance(x[i - d + m * j], x[i + d + m * j]) / (2 * d * h) - 1
    return load / along, -across / along


def hangs_by_bias(v, h):
    """The same of a strip along the diagonal, whose borders are stairs: its width is
    taken from the area of its cells, which is wrong by a part of a cell."""
    step = h * math.sqrt(0.5)  # between rows across
    half, rows = around(WIDE / 2 / step), around(LENGTH / step)
    first = half + 1
    last = first + rows // 2 * 2
    side = (last + half) // 2 + 2
    s = sheet(v, side, side, h)
    s.material.density = WEIGHT / G
    s.scene.settings.gravity = [G * math.sqrt(0.5), -G * math.sqrt(0.5), 0]
    row = s.i + s.j
    s.hole[:] = (abs(s.i - s.j) > half) | (row > last) | (row < first)
    for p in np.flatnonzero((s.hole == 0) & (row <= first + 1)):
        s.pin(p % side, p // side)
    c = (first + last) // 4  # of the diagonal's i
    below = 0  # twice the cells whose middle is below the place
    for p in s.cells():
        below += 1 + np.sign(row[p] + 1 - 2 * c)
    if not rest(s, 1e-9):
        return NAN, NAN
    d, at = half // 4 + 1, side + 1
    length = 2 * d * h * math.sqrt(2)
    x = s.x
    along = distance(x[(c - d) * at], x[(c + d) * at]) / length - 1
    across = distance(x[c * at - d * (side - 1)], x[c * at + d * (side - 1)]) / length - 1
    return (WEIGHT * below / 2 * h * h / ((2 * half) * step) / along, -across / along)


def tension(v):
    if v.bits == 32:  # strains of 1e-4 are not in 24 bits
        return
    for way, found, due, bar in (
            ("warp", hangs_by_warp, (910, 0.3), 0.005),
            ("bias", hangs_by_bias, (821.0526315789474, 0.3684210526315789),
             0.1 if v.quick else 0.03)):
        measure(v, [Property(f"{what} of a hanging strip in {way}", unit, theory, bar,
                             True, True)
                    for what, unit, theory in zip(("Young's modulus", "Poisson's ratio"),
                                                  ("N/m", "1"), due)],
                CELLS[:2 if v.quick else SIZES], lambda h, found=found: found(v, h))


# A fabric by its measured tensions

# Jet-set of Wang, O'Brien and Ramamoorthi 2011, in the order of enum drape_table: the
# stiffnesses C11, C12, C22, N/m, with 1 along the direction, at rest and at a strain of
# a sixth.
JET_SET = {"warp": ((43.07, 54.37, 171.42), (75.15, 82.20, 236.16)),
           "weft": ((171.42, 54.37, 43.07), (404.87, -21.87, 227.03))}


def tension_at(way, e):
    """The tension of a strip with free sides at strain e: the stiffness, linear in e, by
    Green's strain, times 1 + e, as it is by the width at rest."""
    c11, c12, c22 = (at_rest + 6 * e * (strained - at_rest)
                     for at_rest, strained in zip(*JET_SET[way]))
    return (1 + e) * (c11 - c12 * c12 / c22) * (e + e * e / 2)


def hung_strain(v, way, rows, load):
    """The strain in the middle row of cells of a strip along u or v that hangs in so
    many rows, an odd number. This row bears the weight below its middle: `load` N/m."""
    h = LENGTH / rows
    across, warp = around(WIDE / h) + 1, way == "warp"
    m, n = (rows + 1, across) if warp else (across, rows + 1)
    s = sheet(v, m, n, h)
    s.material.stretch, s.material.shear, s.material.bend = 240, 7.16, 1.96e-5
    for o, each in enumerate(JET_SET):  # tables with points at strains of k/90
        for k in range(1, 16):
            s.material.table[o][k - 1] = [k / 90, tension_at(each, k / 90)]
    s.material.density = load / (LENGTH / 2) / G
    if warp:
        s.scene.settings.gravity = [G, 0, s.scene.settings.gravity[2]]
    for k in range(across):
        s.pin(*((0, k) if warp else (k, 0)))
    s.scene.settings.newton = 8
    if not rest(s, 1e-9 if v.bits == 64 else 1e-6):
        return NAN
    step, side = (1, m) if warp else (m, 1)
    upper = across // 2 * side + rows // 2 * step
    axis = 0 if warp else 1
    return abs(s.x[upper + step, axis] - s.x[upper, axis]) / h - 1


def measured(v):
    for way in JET_SET:
        for strain in 0.02, 0.05, 0.12:
            load = tension_at(way, strain)
            p = Property(f"strain of a hanging strip in {way}; at {load:.3g} N/m", "1",
                         strain, 0.02, True, True)
            for rows in (9, 15, 31, 61)[:2 if v.quick else SIZES]:
                p.add(LENGTH / rows, hung_strain(v, way, rows, load))
            v.end(p)


# The largest strain of a sheet that hangs by two corners

def largest(v, limit, h):
    """Of a square of 0.5 m of the default cotton, %. The strain at a corner grows as the
    cells shrink, since a point holds a finite force there."""
    m = around(0.5 / h) + 1
    s = sheet(v, m, m, h)
    s.material.limit = [limit, limit, 2 * limit]
    # long steps pass the limit at once
    s.scene.settings.newton = 8 if limit > 0 else 1
    s.x[:, 0] *= 0.95  # the corners 5 % nearer, and a sag
    s.pin(0, 0)
    s.pin(m - 1, 0)
    for x in s.x:
        x[2] = 0.01 * sin(9 * x[0]) * (1 + x[1])
    if not rest(s, 1e-5 if v.bits == 64 else 1e-4):
        return NAN
    x = s.x.reshape(m, m, 3)
    along, across = distance(x[:, 1:], x[:, :-1]), distance(x[1:], x[:-1])
    return max(0, *(100 * (d.max() / h - 1) for d in (along, across)))


def hung(v):
    if v.quick:
        return
    for p, limit in ((Property("largest strain; by two corners", "%", 0, 5), 0),
                     (everywhere("largest strain; limit of 5 %", "%", 0, 5.5), 0.05)):
        measure(v, [p], (0.05, 0.025, 0.0125, 0.00625),
                lambda h, limit=limit: largest(v, limit, h))
