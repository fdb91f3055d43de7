# SPDX-License-Identifier: Apache-2.0
"""A sheet on a slope, and a small sheet that slides down a ball of flat facets.
spec/validation.md §9"""
import math
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from validate.property import SIZES, everywhere
from validate.world import G, NAN, around, sheet, total, world_of


def slide_down(v, degrees, friction, triangles, h):
    """How far a sheet of 0.4 m slides down a plane of so many triangles in half a second,
    over Coulomb's way from rest; the first tenth is left out, as it falls onto the plane.
    And the largest quotient of friction and normal force of a contact in a step."""
    a = degrees * math.pi / 180
    c, d, m, dt = cos(a), sin(a), around(0.4 / h) + 1, 1 / 60
    s = sheet(v, m, m, h)
    # The plane is turned about z, the sheet at its thickness above it.
    gap = 1.001 * min(s.material.thickness, h / 2)
    along = h * s.i
    s.x[:, 0] = c * along - d * gap
    s.x[:, 1] = d * along + c * gap
    s.x[:, 2] = h * s.j - 0.2
    # One triangle under the sheet, or two whose edge is under it.
    corners = [(-9 * c, -9 * d, -9), (9 * c, 9 * d, -9), (9 * c, 9 * d, 9),
               (-9 * c, -9 * d, 9), (-9 * c, -9 * d, 40)]
    under = [(0, 4 if triangles == 1 else 2, 1), (0, 3, 2)][:triangles]
    s.scene.body(corners, under, friction)
    s.material.friction = friction
    s.scene.settings.max_slices, s.scene.settings.tolerance = 32, 1e-5
    way, speed, most = {}, 0, 0
    world = world_of(s, dt)
    for k in range(1, 37):
        if not world or not world.step():
            return NAN, most
        most = world.steepest(most)
        if k in (6, 36):
            world.read()
            x, u = world.x[:s.count], world.u[:s.count]
            way[k] = total(-((c * x[:, 0] + d * x[:, 1]) / s.count))
            if k == 6:
                speed = total(-((c * u[:, 0] + d * u[:, 1]) / s.count))
    time, pull = 0.5, G * (d - friction * c)
    went = way[36] - way[6]
    return (went / (speed * time + pull * time * (time + dt) / 2) if pull > 0 else went,
            most)


def contact(v):
    if v.quick:
        return
    cells = (0.04, 0.02, 0.4 / 30, 0.01)[:SIZES if v.bits == 64 else SIZES - 1]
    for friction, triangles in ((0, 1), (0.2, 1), (0.3, 1), (0.5, 1), (0, 2), (0.2, 2)):
        rests = friction > math.tan(20 * math.pi / 180)
        slope = f"slope of 20 degrees; friction {friction:g}"
        two = "; two triangles" if triangles > 1 else ""
        what, unit, due, bar = (("way in 0.5 s", "m", 0, 1e-3) if rests else
                                ("way over Coulomb's", "1", 1, 0.02))
        p = everywhere(f"{slope}; {what}{two}", unit, due, bar)
        cone = everywhere(f"{slope}{two}; largest quotient of a contact in a step; over "
                          "its coefficient", "1", 1, 1e-3)
        for h in cells:
            way, most = slide_down(v, 20, friction, triangles, h)
            p.add(h, way)
            cone.add(h, np.fmax(1, np.float64(most) / friction))
        v.end(p)
        if friction > 0:
            v.end(cone)


# A ball of facets

RADIUS, SIZE, START, SECONDS = 2, 0.2, 0.6, 0.4


def place(radius, along, across):
    """The point of a ball at two angles from its pole, along the way and across."""
    return (radius * sin(along), radius * cos(along) * cos(across),
            radius * cos(along) * sin(across))


def facets(cells):
    """The part of the ball that the sheet comes to, in cells² pairs of triangles."""
    m = cells + 1
    x = [place(RADIUS, START - 0.3 + 1.2 * (k % m) / cells, 0.6 * (k // m) / cells - 0.3)
         for k in range(m * m)]
    corners = [(k % cells + m * (k // cells)) for k in range(cells * cells)]
    return x, [t for p in corners for t in ((p, p + 1, p + m), (p + 1, p + m + 1, p + m))]


def angle_due(friction, dt, start):
    """Where a point is that slides by Coulomb's law, θ'' R = g sin θ − μ (g cos θ − R θ'²),
    in as long steps: the new speed moves it, as in Baraff–Witkin's, which adds half a step
    of way. Its load is that of the step's start; with the ground's push along the normal
    of the step's end, as backward Euler has it, the point would go up to 1.2 % farther."""
    a, w = start, 0
    for _ in range(around(SECONDS / dt)):
        push = max(0, G * cos(a) / RADIUS - w * w)
        w += dt * (G * sin(a) / RADIUS - friction * push)
        a += dt * w
    return a


@dataclass
class Ride:
    """A sheet of side² particles on a ball cut in cells² pairs of triangles. chaotic: the
    median of several starts counts."""
    side: int
    cells: int
    friction: float
    dt: float
    tolerance: float
    chaotic: bool = False

    def go(self, s, friction, dt, seconds):
        """Steps from where the sheet is at rest, to where it is then. Returns the angle at
        which its middle is then, NaN: a step failed; and the largest quotient of friction
        and normal force of a contact in a step."""
        s.material.friction = s.scene.bodies[0].friction = friction
        world, most = world_of(s, dt), 0
        for _ in range(around(seconds / dt)):
            if not world or not world.step():
                return NAN, most
            most = world.steepest(most)
        world.read()
        s.x[:] = world.x[:s.count]
        x, y, _ = total(s.x)
        return math.atan2(x, y), most

    def way(self, v, start):
        """The sheet's way over a point's, and that quotient. It starts at rest, where half
        a second with much friction has left it: as it is laid, it is above the facets'
        middles."""
        h = SIZE / (self.side - 1)
        s = sheet(v, self.side, self.side, h)
        s.material.bend = 1e-6
        gap = min(s.material.thickness, h / 2)
        for p in range(s.count):
            s.x[p] = place(RADIUS + gap,
                           start + (h * (p % self.side) - SIZE / 2) / RADIUS,
                           (h * (p // self.side) - SIZE / 2) / RADIUS)
        s.scene.body(*facets(self.cells))
        s.scene.settings.max_slices = 32
        s.scene.settings.tolerance = self.tolerance
        first, _ = self.go(s, 2, 1 / 60, 0.5)
        last, most = self.go(s, self.friction, self.dt, SECONDS)
        return (last - first) / (angle_due(self.friction, self.dt, first) - first), most

    def usual(self, v):
        """The way from START; of a chaotic ride the median of those from starts that are
        2 µm apart; and the quotient of the last of them."""
        found = [self.way(v, START + 1e-6 * k) for k in range(5 if self.chaotic else 1)]
        ways = sorted(way for way, _ in found)
        good = np.isfinite(ways).all()
        return ways[len(ways) // 2] if good else NAN, found[-1][1]


def add_rides(v, name, promised, rides, sizes):
    """The way, and the quotient of contacts, at so many sizes: of a step, or of a cell."""
    p = everywhere(name, "1", 1, 0.05, promised)
    cone = everywhere(f"{name.rpartition(';')[0]}; largest quotient of a contact in a step; "
                      "over its coefficient", "1", 1, 1e-3, False)
    for size, ride in zip(sizes, rides):
        way, most = ride.usual(v)
        p.add(size, way)
        cone.add(size, np.fmax(1, np.float64(most) / ride.friction))
    v.end(p)
    if rides[0].friction > 0 and not promised:
        v.end(cone)


def ball(v):
    if v.bits == 32:
        return
    # The coarse cells of the last rows, which are promised and also part of the small form
    add_rides(v, "facets of 40 mm; friction 0.3; cells of 10 and 5 mm; median way over a "
              "point's", True,
              [Ride(side, 60, 0.3, 1 / 60, 1e-3, True) for side in (21, 41)],
              (SIZE / 20, SIZE / 40))
    if v.quick:
        return
    steps = [1 / (60 << c) for c in range(SIZES)]
    for cells in 10, 30, 100:  # of 10 mm, by steps
        for friction in 0, 0.2:
            add_rides(v, f"facets of {2400 // cells} mm; friction {friction:g}; way over a "
                      "point's", False,
                      [Ride(21, cells, friction, dt, 1e-5) for dt in steps], steps)
    sides = 21, 41, 61, 121  # steps of 1/60 s and the default tolerance, by cells
    for friction in 0, 0.3:
        add_rides(v, f"facets of 40 mm; friction {friction:g}; by cells; way over a "
                  "point's", False,
                  [Ride(side, 60, friction, 1 / 60, 1e-3) for side in sides],
                  [SIZE / (side - 1) for side in sides])
