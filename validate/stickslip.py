# SPDX-License-Identifier: Apache-2.0
"""Stick and slip of a strip that is pressed onto a floor. spec/validation.md §12"""
import math
from math import cos, sin

import numpy as np

from validate.property import SIZES, Property
from validate.theory import runge_kutta, shoot
from validate.world import NAN, sheet, world_of


def from_clamp(u, s):
    """y at the arc length s, by the forces u[0], u[1] of the floor on the tip, aside and
    up, and the curvature u[2] at the clamp: shapes of a part of a strip are those of a
    shorter one. y: distance from the clamp's line, depth, angle from straight down, its
    derivative."""
    side, up = u[0] * s * s, u[1] * s * s

    def slope(_, y):
        return sin(y[2]), cos(y[2]), y[3], -(side * cos(y[2]) + up * sin(y[2]))

    aside, depth, *rest = runge_kutta(slope, [0, 0, 0, u[2] * s], 200)
    return aside * s, depth * s, *rest


def at_tip(depth, aside):
    """What a tip misses that turns freely, of which is known where it is."""
    def miss(u):
        y = from_clamp(u, 1)
        return y[3], y[1] - depth, y[0] - aside
    return miss


def equilibrium(share, increments=30):
    """The unknowns of a strip that is pressed by a share of its length while its tip
    stands below the clamp; None: not found. A column that is clamped and hinged buckles
    at Euler's load k², tan k = k, to a shape of slope a (1 - cos ks - k sin ks), which
    the shortening, half the mean of its square, gives the amplitude a."""
    k, start, mean = 4.493409457909064, share / increments, 0
    for i in range(1000):
        at = k * (i + 0.5) / 1000
        mean += (1 - cos(at) - k * sin(at))**2 / 2000
    a = math.sqrt(start / mean)
    u = [-k * k * a, k * k, -k * k * a]
    for i in range(1, increments + 1):
        u = shoot(u, at_tip(1 - start * i, 0))
        if u is None:
            return None
    return u


def quotient(u):
    """The floor's forces on a tip, over one another; NaN: none found."""
    return abs(u[0]) / u[1] if u else NAN


def share_of(q):
    """The share by which the strip is pressed when the tip stands and this quotient
    is q."""
    def miss(u):
        return *at_tip(1 - u[3], 0)(u[:3]), quotient(u) - q
    return shoot([*equilibrium(0.2), 0.2], miss)[3]


def rests(share, friction):
    """The ways from below the clamp at which a tip that has slid as far as it can may
    rest, of the length: where the quotient is within the friction. The more a tip slides
    the harder it is driven, until the strip is bent to one side."""
    ways, far, aside = [], False, 0
    u = equilibrium(share)
    while u and u[1] > 0:
        u = shoot(u, at_tip(1 - share, aside))
        q = quotient(u)
        far = far or q > 2 * friction
        if far and q <= friction:
            ways.append(aside)
        elif len(ways) > 1:
            break
        aside += 1e-3
    return (ways[0], ways[-1]) if len(ways) > 1 else (NAN, NAN)


LENGTH, THICKNESS = 0.1, 2e-4  # m
FIRST = 0.05  # the share by which it starts pressed
# Steps until the strip has settled on the floor, and until the clamp rests; until a tip
# that stands, or one that has slid and swings for a while, rests as well; and of these
# the last ones, in which the forces are measured.
SETTLED, PRESSES, STANDS, RESTS, LAST = 60, 480, 600, 1800, 60
EDGE = 0.98


def strip(v, cells, share):
    """A strip of so many cells of length and one of width, clamped upright, that starts
    buckled: a straight one would snap when its load passes Euler's. Two rows are pinned,
    so the clamp is half a cell before the second of them; a motion presses them."""
    h = LENGTH / (cells - 0.5)
    s = sheet(v, 2, cells + 1, h)
    s.material.bend, s.material.density = 1e-5, 0.2
    s.material.thickness = THICKNESS
    u = equilibrium(FIRST)
    before = 0, -h / 2 / LENGTH
    for k in range(cells):  # a row to the next, a chord as long as the cell
        at = from_clamp(u, (k + 0.5) / (cells - 0.5))[:2]
        aside, down = at[0] - before[0], at[1] - before[1]
        part = h / np.hypot(aside, down)
        for p in 2 * k + 2, 2 * k + 3:
            s.x[p, 2] = s.x[p - 2, 2] + part * aside
            s.x[p, 1] = s.x[p - 2, 1] - part * down
        before = at
    return s


class Press:
    """What the floor does. quotient: friction over normal force, and way: the tip's, of
    the length, at the end; whole, most: the greatest quotient of the two forces in a
    step, and of the two impulses of a contact, over the coefficient, until the tip has
    slid by a twentieth of the length; share: by which the strip is pressed when the
    quotient reaches `EDGE` of the coefficient. NaN: a step failed."""

    def __init__(self, v, share, friction, steps, cells):
        self.quotient = self.way = self.share = NAN
        self.whole = self.most = 0
        s = strip(v, cells, share)
        scene = s.scene
        motion = scene.keys([0, 2], [(0, 0, 0), (0, (FIRST - share) * LENGTH, 0)])
        for k in range(4):
            s.pin(k % 2, k // 2, motion)
        low = s.x[-1, 1] - 0.999 * THICKNESS
        scene.body([(-9, low, -9), (0, low, 9), (9, low, -9)], [(0, 1, 2)], friction)
        s.material.friction = friction
        scene.settings.max_slices = 32
        scene.settings.gravity = [0, 0, 0]
        world = world_of(s, 2 / PRESSES)
        if not world or not self.press(world, share, friction, steps, s):
            self.quotient = self.way = self.share = self.whole = self.most = NAN

    def press(self, world, share, friction, steps, s):
        """Takes the steps."""
        end, before, stands = np.zeros(2), 0, True
        for k in range(steps):
            if not world.step():
                return False
            contacts, impulse, _ = world.contacts()
            forces = contacts["impulse"]
            across, up = np.hypot(forces[:, 0], forces[:, 2]), abs(forces[:, 1])
            most = np.fmax.reduce((across / up / friction)[up > 0], initial=0)
            both = np.array([impulse[0][2], impulse[0][1]])
            q = abs(both[0] / both[1]) / friction
            world.read()
            self.way = abs(world.x[s.count - 1, 2] - s.x[-1, 2]) / LENGTH
            stands = stands and self.way < 0.05
            if stands and k >= SETTLED:
                self.whole = np.fmax(self.whole, q)
                self.most = max(self.most, most)
            if k >= SETTLED and math.isnan(self.share) and q >= EDGE:
                self.share = FIRST + (share - FIRST) / PRESSES * (
                    k + (EDGE - before) / (q - before))
            before = q
            if k >= steps - LAST:
                end += both
        self.quotient = abs(end[0] / end[1])
        return True


CELLS = 12, 25, 50, 100


def rows(v, title, rows_of, found):
    for cells in CELLS[:2 if v.quick else SIZES]:
        f = found(cells)
        for p, kind in rows_of:
            p.add(LENGTH / cells, getattr(f, kind))
    for p, _ in rows_of:
        p.name, p.promised = title + p.name, True
        v.end(p)


def stand(v, share):
    """A tip that stands."""
    rows(v, f"friction 1 stands; pressed by {share:g} L; ", [
        (Property("friction over normal force", "1", quotient(equilibrium(share)), 0.03,
                  share=True), "quotient"),
        (Property("way of the tip", "of L", 0, 0.005), "way")],
        lambda cells: Press(v, share, 1, STANDS, cells))


def slide(v, share, friction):
    """A tip that slides away when friction does not suffice."""
    way = rests(share, friction)
    rows(v, f"friction {friction:g}; pressed by {share:g} L; ", [
        (Property("share of L at which friction is 0.98 of the coefficient", "1",
                  share_of(EDGE * friction), 0.05, share=True), "share"),
        (Property("greatest friction over normal force; over the coefficient", "1", 1,
                  0.03), "whole"),
        (Property("the same of a contact", "1", 1, 1e-3), "most"),
        (Property("friction over normal force at rest; within the coefficient", "1", 0,
                  friction), "quotient"),
        (Property("way of the tip at rest", "of L", (way[0] + way[1]) / 2,
                  (way[1] - way[0]) / 2), "way")],
        lambda cells: Press(v, share, friction, RESTS, cells))


def stickslip(v):
    if v.bits == 32:
        return
    stand(v, 0.1)
    if v.quick:
        return
    stand(v, 0.3)
    slide(v, 0.3, 0.2)
    slide(v, 0.3, 0.3)
