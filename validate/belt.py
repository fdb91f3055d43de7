# SPDX-License-Identifier: Apache-2.0
"""A belt on a drum: the capstan's law. spec/validation.md §15"""
import math
from dataclasses import dataclass, replace

import numpy as np

from validate.property import everywhere, measure
from validate.scheme import PLAIN, Scheme, schemes
from validate.world import NAN, Scene, around, distance, total

RADIUS, SPAN = 0.1, 0.1  # m, of drum and free parts
STRAIN = 0.0036  # at the start


def drum(scene, radius, half, facets, friction):
    """Adds the mantle of a drum along z of this radius and half length: so many facets,
    whose edges are on the round drum."""
    x, triangles = [], []
    for k in range(facets):
        angle = 2 * math.pi * k / facets
        at = radius * math.cos(angle), radius * math.sin(angle)
        x += [(*at, -half), (*at, half)]
        a, b = 2 * k, 2 * ((k + 1) % facets)
        triangles += [(a, b, a + 1), (b, b + 1, a + 1)]
    scene.body(x, triangles, friction)


@dataclass
class Belt:
    """A belt over half of a drum, both ends straight down, without gravity. wide: cells
    across; pull, give: how fast the ends move, m/s, from `begin` to `end`.

    What is seen of it: quotient: the logarithm of the two tensions' quotient over that of
    the law, in the mean of the last third; aside: the speed across the belt over that
    along it; onset: the quotient at which the far end's tension has grown by a tenth;
    keeps: its change after the ends have stopped."""
    friction: float = 0.3
    cell: float = 0.008
    dt: float = 1 / 60
    wide: int = 4
    facets: int = 128
    how: Scheme = PLAIN
    pull: float = 0.01
    give: float = 0.01
    begin: float = 0.1
    end: float = 9
    time: float = 1.1

    def wind_up(self, v):
        self.quotient = self.aside = self.onset = self.keeps = NAN
        scene = Scene(v, self.how, self.dt)
        scene.settings.gravity = [0, 0, 0]
        scene.material.friction = self.friction
        out = RADIUS + min(scene.material.thickness, self.cell / 2)
        arc = math.pi * out
        whole = arc + 2 * SPAN
        m, n = around(whole / self.cell) + 1, self.wide + 1
        self.m, self.n = m, n
        self.rest = whole / (1 + STRAIN) / (m - 1)
        belt = scene.sheet(m, n, self.rest)
        for k, x in enumerate(belt.x):
            s = whole * (k % m) / (m - 1)
            a = math.pi - (s - SPAN) / out
            if SPAN < s < SPAN + arc:
                x[:2] = out * math.cos(a), out * math.sin(a)
            elif s <= SPAN:
                x[:2] = -out, s - SPAN
            else:
                x[:2] = out, SPAN + arc - s
            # narrower by Poisson's ratio
            x[2] = self.rest * (k // m - 0.5 * self.wide) * (1 - 0.3 * STRAIN)
        drum(scene, RADIUS, self.rest * self.wide + 0.05, self.facets, self.friction)
        for i, speed in ((0, self.give), (m - 1, -self.pull)):
            motion = scene.motion(self.begin, self.end, 0.1, (0, speed, 0))
            for j in range(n):
                belt.pin(i, j, motion)
        return scene.world()

    def strain(self, x, a, b):
        """The mean strain along the belt between two columns."""
        return total(distance(x[:, a], x[:, b]) / ((b - a) * self.rest) - 1) / self.n

    def tensions(self, world):
        """Tensions of both free parts, in their middles, as strains."""
        x = world.x[:self.m * self.n].reshape(self.n, self.m, 3)
        a, b = around(0.25 * SPAN / self.rest), around(0.75 * SPAN / self.rest)
        return self.strain(x, a, b), self.strain(x, self.m - 1 - b, self.m - 1 - a)

    def draw(self, v):
        world, law = self.wind_up(v), self.friction * math.pi
        if not world or not world.until(self.begin):
            return self
        first = self.tensions(world)[0]
        steps = around((self.time - self.begin) / self.dt)
        mean = across = at_end = last = 0
        for k in range(steps):
            if not world.goes():
                return self
            low, high = self.tensions(world)
            quotient = np.log(high / low) / law
            if math.isnan(self.onset) and low / first > 1.1:
                self.onset = quotient
            if at_end == 0 and world.steps * self.dt > self.end:
                at_end = quotient
            if 3 * k > 2 * steps:
                mean += quotient
                count = self.m * self.n
                aside = world.u[:count, 2][world.x[:count, 1] > 0.02]
                across += math.sqrt(total(aside * aside) / len(aside))
                last += 1
        self.quotient = mean / last
        self.aside = across / last / max(abs(self.pull), 1e-3)
        self.keeps = np.float64(mean) / last / at_end
        return self


def slides(v, name, belt, sizes, cells=False):
    """Rows of sliding belts by cells or steps."""
    width = belt.wide * belt.cell

    def found(size):
        one = replace(belt, cell=size, wide=around(width / size)) if cells else replace(
            belt, dt=size)
        one.draw(v)
        return one.quotient, one.aside

    measure(v, [everywhere(f"slides; {name}; logarithm of tensions' quotient over the law's",
                           "1", 1, 0.05, belt.friction > 0.1),
                everywhere(f"slides; {name}; speed across the belt over that along it", "1",
                           0, 0.05)], sizes, found)


def sticks(v, how, steps):
    """One end is drawn, the other held: it feels nothing until the quotient is the law's.
    Drawn by less, the belt keeps its tensions."""
    def found(dt):
        # by its beginning it lies still on its facets
        belt = Belt(dt=dt, how=how, give=0, pull=2e-3, begin=0.5, time=2)
        return belt.draw(v).onset, replace(belt, end=0.7).draw(v).keeps

    measure(v, [everywhere(f"sticks; {how.name}; onset; logarithm of tensions' quotient over "
                           "the law's", "1", 1, 0.05),
                everywhere(f"sticks; {how.name}; the same after 1 s over that before", "1",
                           1, 0.05)], steps, found)


def belt(v):
    steps = 1 / 60, 1 / 240
    if v.quick:
        if v.bits == 64:
            slides(v, "friction 0.3", Belt(cell=0.012, wide=2, time=0.7), steps[:1])
        return
    for friction in 0.1, 0.3, 0.6:
        slides(v, f"friction {friction:g}", Belt(friction), steps)
    for how in schemes(v)[1:]:
        slides(v, how.name, Belt(how=how), steps)
    for wide in 4, 2:
        slides(v, f"friction 0.3; by cells; {12 * wide} mm wide", Belt(cell=0.012, wide=wide),
               (0.012, 0.008, 0.004)[:3 if v.bits == 64 else 2], True)
    for facets in 16, 40:
        slides(v, f"friction 0.3; {facets} facets", Belt(facets=facets), steps)
    for how in schemes(v):
        sticks(v, how, steps)
