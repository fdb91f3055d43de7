# SPDX-License-Identifier: Apache-2.0
"""Scenes of cloth without contact, for time against error, orders and stability; and
sheets and obstacles for scenes with contact."""
import math

import numpy as np

from validate.world import Scene

# stretched: the border is pinned, all springs are in tension; hanging: held by its upper
# edge, released 2 % too long; flag: held by one edge, in wind; falling: held by two
# corners, released flat; swinging: hangs by one edge, released at 0.3 rad.
HELD = {"stretched": lambda i, j, last: {i, j} & {0, last},
        "hanging": lambda i, j, last: j == 0, "flag": lambda i, j, last: i == 0,
        "falling": lambda i, j, last: j == 0 and i in (0, last),
        "swinging": lambda i, j, last: j == 0}
WIND = ([7, 0, 1.5], 1.2, 1, 0.5)


def start(kind, a, b):
    """Where particles at a, b in [0, 1], their places in the cloth, start, and how fast:
    smooth, and 0 where the cloth is held."""
    w, zero = 16 * a * (1 - a) * b * (1 - b), 0 * a
    return {"stretched": ((1.3 * a, 1.2 * b, zero),
                          (0.5 * w * (a - 0.3), 0.3 * w * b, w)),
            "hanging": ((1.02 * a, -1.02 * b, zero), (zero, zero, b * b * (a - 0.3))),
            "flag": ((1.02 * a, -1.02 * b, zero), (zero, zero, a * a * (b - 0.3))),
            "falling": ((a, zero, b), (zero, zero, zero)),
            "swinging": ((a, -0.955336489 * b, 0.295520207 * b),
                         (zero, zero, zero))}[kind]


class Sample(Scene):
    """A sheet of 1 m × 1 m with side × side particles, by one of the names of HELD."""

    def __init__(self, b, kind, side):
        super().__init__(b)
        self.settings.self_collision = 0
        self.cloth = sheet(self, side, 1, 0)
        x, v = start(kind, self.cloth.i / (side - 1), self.cloth.j / (side - 1))
        self.cloth.x, self.cloth.v = np.stack(x, 1), np.stack(v, 1)
        for i, j in zip(self.cloth.i.tolist(), self.cloth.j.tolist()):
            if HELD[kind](i, j, side - 1):
                self.cloth.pin(i, j)
        if kind == "flag":
            self.settings.wind = WIND


def scene(b):
    """A scene for contact, with all of the library's defaults."""
    made = Scene(b)
    made.settings.sleep = 1
    return made


def sheet(made, side, size, height):
    """Adds a flat sheet of side × side particles, `size` m wide, with its middle at x = z
    = 0, which starts at the places that the library gives it."""
    cloth = made.sheet(side, side, size / (side - 1))
    cloth.struct.width = cloth.struct.height = size
    cloth.struct.origin = [-size / 2, height, -size / 2]
    cloth.x = cloth.v = None
    return cloth


def ball(radius, at, detail):
    """The vertices and triangles of a sphere of rings of `detail` vertices; the two poles
    are the last vertices."""
    rings = detail // 2 - 1
    n = rings * detail
    x, tri = [], []
    for p in range(n):
        a = math.pi * (p // detail + 1) / (rings + 1)
        b = 2 * math.pi * (p % detail) / detail
        x.append((math.sin(a) * math.cos(b), math.cos(a), math.sin(a) * math.sin(b)))
        right = p // detail * detail + (p + 1) % detail
        tri.append((p, right, n if p < detail else right - detail))
        tri.append((p, n + 1 if p + detail >= n else p + detail, right))
    x += [(0, 1, 0), (0, -1, 0)]
    return np.array(at, float) + radius * np.array(x), np.array(tri, np.int32)


def plane(size):
    """A level square around the origin."""
    a = size / 2
    return [(-a, 0, -a), (a, 0, -a), (-a, 0, a), (a, 0, a)], [(0, 2, 1), (1, 2, 3)]
