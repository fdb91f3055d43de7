#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Derives the hardest inputs of the exact predicates and writes them with their
answers, which rational arithmetic gives: tests/narrow/hardest.def.

usage: tests/narrow/hardest.py [--check]    --check: whether the file has what it writes

A determinant of integers that is not 0 is at least 1. Neighbours in Fibonacci's
sequence, F(n+1) F(n-1) - F(n)² = ±1, and powers of a matrix of determinant 1 reach that
with numbers as long as the significand allows: no sign is harder for a filter, whose
error grows with the products. Sums of rows are exactly 0. A coordinate of 2^-1074 beside
2^60 makes the longest integers; there it decides the sign. A vertex that passes an edge
of a face, and an edge that passes another's, do so by such a determinant at a time that
is no binary number.
"""
import math
import os
import sys
from fractions import Fraction

PATH = "tests/narrow/hardest.def"
TINY, GREAT = 2.0**-1074, 2.0**60
GRID = 1 << 30


def fibonacci(bits):
    """The three longest neighbours of so many bits, ascending."""
    a, b, c = 1, 1, 2
    while b + c < 1 << bits:
        a, b, c = b, c, b + c
    return a, b, c


def power(bits):
    """The largest power of a matrix of determinant 1 whose entries have so many bits."""
    step, m = [[1, 1, 1], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    while True:
        new = [[sum(m[i][k] * step[k][j] for k in range(3)) for j in range(3)]
               for i in range(3)]
        if max(map(max, new)) >= 1 << bits:
            return m
        m = new


def sign(x):
    """-1, 0 or 1"""
    return (x > 0) - (x < 0)


def orient2(a, b, c):
    """The sign of (b - a) × (c - a)."""
    x, y = ([Fraction(p[k]) - Fraction(a[k]) for k in range(2)] for p in (b, c))
    return sign(x[0] * y[1] - x[1] * y[0])


def orient3(a, b, c, d):
    """The sign of (b - a) × (c - a) · (d - a)."""
    x, y, z = ([Fraction(p[k]) - Fraction(a[k]) for k in range(3)] for p in (b, c, d))
    return sign(sum(z[k] * (x[(k + 1) % 3] * y[(k + 2) % 3]
                            - x[(k + 2) % 3] * y[(k + 1) % 3]) for k in range(3)))


def moved(points, by):
    """Points moved by integers so that they stay exact; else None."""
    new = [[p + m for p, m in zip(point, by)] for point in points]
    good = all(Fraction(float(x)) == x for point in new for x in point)
    return new if good else None


def planes():
    """Points of orient2."""
    f, g, h = fibonacci(52)
    yield [0, 0], [h, g], [g, f]
    yield [0, 0], [g, f], [h, g]
    yield [0, 0], [h, g], [2 * h, 2 * g]
    yield [-f, -g], [h - f, g - g], [g - f, f - g]
    yield [0, 0], [h * 2.0**-900, g * 2.0**-900], [g * 2.0**-120, f * 2.0**-120]
    yield [TINY, 0], [GREAT, GREAT], [GREAT, GREAT]
    yield [0, TINY], [GREAT, GREAT], [GREAT / 2, GREAT / 2]
    yield [0, 0], [GREAT, TINY], [GREAT / 2, TINY]
    yield [0, 0], [GREAT, GREAT], [GREAT, GREAT * (1 - 2.0**-53)]
    for k in range(1, 12): # 53 bits that end differently
        a, b, c = fibonacci(53 - k)
        yield [0, 0], [c << k, b << k], [b, a]
        yield [0, 0], [c + k, b], [b + k, a]


def spaces():
    """Points of orient3."""
    zero, rows = [0, 0, 0], power(52)
    x, y, z = rows
    both = [p + q for p, q in zip(x, y)]
    yield zero, x, y, z
    yield zero, y, x, z
    yield zero, x, y, both
    for k in range(3):
        for step in (1, -1):
            near = [p + step * (j == k) for j, p in enumerate(both)]
            yield zero, x, y, near
            yield zero, x, y, [p / 2 for p in near]
    shifted = moved([zero, x, y, z], [-p for p in x])
    if shifted:
        yield tuple(shifted)
    yield [TINY, 0, 0], [GREAT, GREAT, 0], [GREAT, 0, GREAT], [GREAT, GREAT, 0]
    yield [0, 0, TINY], [GREAT, GREAT, 0], [GREAT, 0, 0], [0, GREAT, 0]
    yield zero, [GREAT, GREAT, GREAT], [GREAT, GREAT, 0], [TINY, 0, GREAT]
    half = GREAT / 2
    yield zero, [half, 0, half], [0, half, half], [half, half, GREAT]
    for k in range(1, 12):
        x, y, z = power(53 - k)
        yield zero, [p << k for p in x], y, z
        yield zero, x, [p * 2.0**-500 for p in y], z


def passes(bits):
    """Vertices that pass an edge, and edges that pass an edge: (kind, x0, x1, time).
    The edge from 0 to b is met from the side on which p is, and p is on it, or beside
    it by a determinant of 1."""
    f, g, h = fibonacci(bits - 2)
    for p in ([g, f], [f, g], [2 * g, 2 * f], [h, g]):
        b = [2 * h, 2 * g] if p == [h, g] else [h, g]
        for side in (1, -1):
            corner = [side * -g, side * h]
            for down in (-1, -2, -6): # z from 1 to this: it is 0 at 1 / (1 - down)
                still = [[0, 0, 0], [*b, 0], [*corner, 0]]
                time = Fraction(1, 1 - down)
                inside = (orient2([0, 0], b, p) * side >= 0
                          and orient2(b, corner, p) * side >= 0
                          and orient2(corner, [0, 0], p) * side >= 0)
                yield 0, [[*p, 1], *still], [[*p, down], *still], inside, time
                far = [p[0] + side * g, p[1] - side * h]
                ends = [orient2([0, 0], b, q) for q in (p, far)]
                cross = ends[0] * ends[1] <= 0 and orient2(p, far, [0, 0]) * orient2(
                    p, far, b) <= 0
                yield (1, [[0, 0, 0], [*b, 0], [*p, 1], [*far, 1]],
                       [[0, 0, 0], [*b, 0], [*p, down], [*far, down]], cross, time)


def numbers(points):
    """Numbers in C, exactly."""
    assert all(Fraction(float(x)) == x for point in points for x in point)
    return ", ".join(float(x).hex().replace("0x0.0p+0", "0") for point in points
                     for x in point)


def rows():
    """The file's rows."""
    for points in planes():
        yield f"ORIENT2({orient2(*points)}, {numbers(points)})"
    for points in spaces():
        yield f"ORIENT3({orient3(*points)}, {numbers(points)})"
    for bits in (24, 53):
        for kind, x0, x1, hit, time in passes(bits):
            toi = str(math.floor(time * GRID)) if hit else "NARROW_MISS"
            yield f"PASS({bits}, {kind}, {toi}, {numbers([*x0, *x1])})"


def text():
    """The file."""
    head = ("/* SPDX-License-Identifier: Apache-2.0 */\n"
            "/* Written by tests/narrow/hardest.py: the hardest inputs of the exact\n"
            " * predicates, and their answers. ORIENT2(sign, points), ORIENT3(sign, points)\n"
            " * and PASS(bits, kind, toi, places at 0 and at 1). */\n")
    return head + "".join(row + "\n" for row in rows())


def main(*options):
    """Writes or compares the file."""
    os.chdir(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    new = text()
    if "--check" in options:
        with open(PATH, encoding="utf-8") as file:
            good = file.read() == new
        print(f"{'ok' if good else 'FAILED'} {PATH}")
        print(f"{int(good)} passed, {int(not good)} failed")
        return 0 if good else 1
    with open(PATH, "w", encoding="utf-8") as file:
        file.write(new)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
