# SPDX-License-Identifier: Apache-2.0
"""Boundary-value problems of thin strips by shooting: the classical Runge–Kutta method,
and Newton's method for what is not known at the start. spec/validation.md §2, §10 to
§12"""
import functools
import math
from math import cos, sin

import numpy as np


def runge_kutta(slope, y, steps):
    """Takes y from s = 0 to s = 1 by y' = slope(s, y)."""
    d = 1 / steps
    for k in range(steps):
        s = k * d
        a = slope(s, y)
        b = slope(s + d / 2, [p + d / 2 * q for p, q in zip(y, a)])
        c = slope(s + d / 2, [p + d / 2 * q for p, q in zip(y, b)])
        e = slope(s + d, [p + d * q for p, q in zip(y, c)])
        y = [p + d / 6 * (q + 2 * r + 2 * t + u)
             for p, q, r, t, u in zip(y, a, b, c, e)]
    return y


def shoot(unknown, miss, close=1e-10):
    """The unknowns, near these, of which no more is missed than `close`; None: not
    found."""
    unknown = list(unknown)
    for _ in range(50):
        b = np.array(miss(unknown))
        if not np.isfinite(b).all():
            return None
        if abs(b).max() < close:
            return unknown
        columns = []
        for c, value in enumerate(unknown):
            step = 1e-6 * (1 + abs(value))
            moved = unknown[:c] + [value + step] + unknown[c + 1:]
            columns.append((np.array(miss(moved)) - b) / step)
        try:
            change = np.linalg.solve(np.column_stack(columns), b)
        except np.linalg.LinAlgError:
            return None
        unknown = [value - one for value, one in zip(unknown, change.tolist())]
    return None


@functools.cache
def elastica(gamma):
    """The heavy elastica: the tip's drop over its distance for Γ = w L³ / D.

    y: φ, how far the strip is from straight down, its derivative, and the tip's distance
    and drop: φ'' = Γ u sin φ, u from the free end. φ at the clamp is π/2 for one start
    alone: a smaller one does not reach it, and beyond it φ swings about π with less and
    less amplitude."""
    def slope(u, y):
        return y[1], gamma * u * sin(y[0]), sin(y[0]), cos(y[0])

    def from_end(start, steps):
        return runge_kutta(slope, [start, 0, 0, 0], steps)

    lo, hi = 0, math.pi / 2
    for _ in range(10):
        middle = (lo + hi) / 2
        if from_end(middle, 100)[0] < math.pi / 2:
            lo = middle
        else:
            hi = middle
    start, = shoot([middle], lambda u: [from_end(u[0], 2000)[0] - math.pi / 2],
                   1e-13)
    _, _, along, drop = from_end(start, 2000)
    return drop / along


class Rod:
    """Kirchhoff's rod, which bends and twists at once. Of length 1 and stiffness 1
    against bending of its surface, clamped level along x; edge: stiffness against
    bending in its plane; roll: of the clamp about x, from lying flat, radian; weight:
    w W L³ by that stiffness."""

    def __init__(self, edge, twist, roll, weight):
        self.edge, self.twist, self.roll, self.weight = edge, twist, roll, weight

    def slope(self, s, y):
        """y: place, tangent, normal of the surface, moment that the part beyond s
        exerts. The frame turns by the moment over the stiffnesses, and the moment falls
        by the tangent times the weight of the part beyond."""
        _, _, _, a, b, c, d, e, f, p, q, r = y
        g, h, i = b * f - c * e, c * d - a * f, a * e - b * d  # across
        by_across = p * g + q * h + r * i
        by_normal = (p * d + q * e + r * f) / self.edge
        by_tangent = (p * a + q * b + r * c) / self.twist
        u = by_across * g + by_normal * d + by_tangent * a
        v = by_across * h + by_normal * e + by_tangent * b
        w = by_across * i + by_normal * f + by_tangent * c
        force = -self.load * (1 - s)
        return (a, b, c, v * c - w * b, w * a - u * c, u * b - v * a,
                v * f - w * e, w * d - u * f, u * e - v * d,
                force * c, 0, -force * a)

    def from_clamp(self, moment):
        start = [0, 0, 0, 1, 0, 0, 0, cos(self.roll), sin(self.roll)]
        return runge_kutta(self.slope, start + list(moment), self.steps)

    def tip(self):
        """Where the free end hangs, y upward; None: no equilibrium was found. At the
        free end there is no moment."""
        moment, increments = [0, 0, 0], 10
        for k in range(1, increments + 1):
            self.load = self.weight * k / increments
            self.steps = 400 if k == increments else 50
            moment = shoot(moment, lambda m: self.from_clamp(m)[9:])
            if moment is None:
                return None
        return self.from_clamp(moment)[:3]
