# SPDX-License-Identifier: Apache-2.0
"""Small sheets that slide down the flanks of statues, and points beside them.
spec/validation.md §9"""
import functools
import math
from dataclasses import dataclass

import numpy as np
from drape._core import lib

from validate.ground import Facets, Smooth, boulder, length, statue as statue_of
from validate.property import SIZES, everywhere
from validate.world import G, NAN, around, cross, dot, sheet, total, world_of

PATHS, SECONDS = 3, 0.25
SIDE, SIZE = 11, 0.04  # of the sheet: particles, m
COUNT = SIDE * SIDE
# s: steps of points beside an integrator of second order, which has none of their error.
FINE = 1 / 960
STATUE = 4  # m, of a statue's largest extent


class Point:
    """A point of 1 kg that slides on a floor. push: N·s, the floor's normal impulse in the
    last step; level: the cosine of its slope there."""

    def __init__(self, x):
        self.x, self.v, self.push, self.level = np.array(x), np.zeros(3), 0, 0

    def step(self, floor, friction, dt, gap, tries=60):
        """One step as in Baraff–Witkin's: the new velocity moves the point, and the floor's
        impulse is along its normal, with friction by Coulomb's law. The point ends `gap`
        over the floor, or higher where the floor need not push. False: nothing is near, or
        on a smooth surface no impulse is found."""
        falling, push, found = self.v.copy(), 0, False
        falling[1] -= dt * G
        n = floor.height(self.x)[1]
        if n is None:
            return False
        # The ground is nearly flat within a step, so the height that is missing, over dt,
        # is nearly the impulse that is missing. Where two facets meet the normal may jump
        # to and fro, and is settled after half of the tries.
        for k in range(tries):
            along = dot(falling, n)
            slip = falling - along * n
            speed = length(slip)
            left = max(0, 1 - friction * push / speed) if speed > 0 else 0
            v = left * slip + (along + push) * n
            x = self.x + dt * v
            height, after = floor.height(x)
            if after is None:
                return False
            if floor.ends and k < tries // 2:
                n = after
            last, push = push, max(0, push + (gap - height) / dt)
            found = abs(push - last) < 1e-9
            if found:
                break
        if not found and not floor.ends:
            return False
        self.x, self.v, self.push, self.level = x, v, push, n[1]
        return True


def slides(g, start, friction):
    """The way of a point that starts at rest; None: it does not stay on the ground, on
    slopes of 15 to 75 degrees, pressed by a quarter of its weight at least, or comes less
    than 0.1 m far."""
    dt, p = 1 / 480, Point(start)
    steep, flat = math.cos(75 * math.pi / 180), math.cos(15 * math.pi / 180)
    for _ in range(around(SECONDS / dt)):
        if (not p.step(g, friction, dt, 0) or p.push < 0.25 * G * dt or
                not steep <= p.level <= flat):
            return None
    return p.x - start if length(p.x - start) > 0.1 else None


def is_certain(g, coarse, start, friction):
    """Whether the point's way says what a sheet's is: within 2 % it is that of a point on a
    ground that is smoothed farther, and the mean of those of four that start 10 mm
    around."""
    way, there = slides(g, start, friction), coarse.put(start, 0)
    other = None if way is None or there is None else slides(coarse, there, friction)
    if other is None:
        return False
    most = 0.02 * length(way)
    if not length(other - way) < most:
        return False
    n, mean = g.height(start)[1], np.zeros(3)
    for axis in (-1, 0, 0), (1, 0, 0), (0, 0, -1), (0, 0, 1):
        side = cross(n, np.array(axis, float))
        x = g.put(start + 0.01 * side / length(side), 0)
        one = None if x is None else slides(g, x, friction)
        if one is None:
            return False
        mean += one / 4
    return length(mean - way) < most


@functools.cache
def find_paths(g, coarse, friction):
    """Places on the smooth surface from which a point slides with this friction as
    validation.md §9 asks. coarse: the same ground, smoothed half as far again."""
    found, triangles = [], g.mesh.triangles
    # Middles of triangles, in an order that has nothing to do with them.
    for k in range(1, len(triangles) + 1):
        a, b, c = g.mesh.x[triangles[k * 7919 % len(triangles)]]
        x = g.put((a + b + c) / 3, 0)
        if x is None:
            continue
        n = g.height(x)[1]
        # gravity less friction pulls a point at rest by 0.3 to 0.6 g
        if (n[1] > 0 and 0.3 < math.sqrt(1 - n[1] * n[1]) - friction * n[1] < 0.6 and
                all(length(x - other) > 0.2 for other in found) and
                is_certain(g, coarse, x, friction)):
            found.append(x)
            if len(found) == PATHS:
                break
    return found


@dataclass
class Method:
    """By what the sheet moves; the name stands in the rows."""
    name: str
    integrator: int
    newton: int


LINEAR = Method("", lib.DRAPE_BW, 0)
SOLVED = Method("newton 4; ", lib.DRAPE_BW, 4)
SECOND = Method("bdf2; ", lib.DRAPE_BDF2, 0)


class Slide:
    """A sheet on its way from a place on the ground, and the point beside it."""

    def __init__(self, v, ground, start, friction, dt, method, rest=None):
        """rest: where its particles start; None: it is laid."""
        self.ground, self.friction, self.dt, self.method = ground, friction, dt, method
        h = SIZE / (SIDE - 1)
        s = self.sheet = sheet(v, SIDE, SIDE, h)
        self.gap = s.material.thickness = h / 4
        s.material.bend, s.material.friction = 1e-6, friction
        near = ground.mesh.near(start, 0.35)
        s.scene.body(near.x, near.triangles, friction)
        settings = s.scene.settings
        settings.max_slices, settings.tolerance = 32, 1e-5
        settings.integrator, settings.newton = method.integrator, method.newton
        put = ground.put(start, self.gap)
        self.point = Point(start if put is None else put)
        if rest is None:
            self.lay(near, h)
        else:
            s.x[:] = rest
        self.world = world_of(s, dt)
        self.start = self.look()[0] if self.world else None
        self.work = self.due = self.steepest = 0

    def lay(self, near, h):
        """Lays the sheet on the ground with its middle where the point is: on the smooth
        surface, and then each particle on the triangle below."""
        at = self.point.x
        n = self.ground.height(at)[1]
        down = (n[1] * n - np.array([0, 1, 0])) / math.sqrt(1 - n[1] * n[1])
        across = cross(n, down)
        for p in range(COUNT):
            i, j = h * (p % SIDE - SIDE // 2), h * (p // SIDE - SIDE // 2)
            x = at + i * down + j * across
            put = self.ground.put(x, self.gap)
            x = x if put is None else put
            up = self.ground.height(x)[1]
            lift = NAN if up is None else near.lift(x, up, self.gap)
            self.sheet.x[p] = x if math.isnan(lift) else x + lift * up

    def look(self):
        """Reads the state. Returns the sheet's middle, which is the mean of its particles,
        moved along the normal to the height of the point, as the mean of a curved sheet is
        too low; None: that is not near the ground; and the speed of the slowest
        particle."""
        self.world.read()
        mean = total(self.world.x[:COUNT] / COUNT)
        return self.ground.put(mean, self.gap), length(self.world.u[:COUNT]).min()

    def add_work(self):
        """Adds friction's work in a step, and what it should be by Coulomb's law: the
        coefficient times normal impulse times slip, of each contact. Both take the
        velocities at the step's end, so that their quotient is a mean of friction over its
        limit."""
        rows = self.world.contacts()[0]
        if not len(rows):
            return
        of = rows["weight"][:, :, None] * self.world.u[rows["vertex"]]
        slip = of[:, 0] + of[:, 1] + of[:, 2] + of[:, 3]
        slip = slip - dot(slip, rows["normal"])[:, None] * rows["normal"]
        self.work -= total(dot(rows["impulse"], slip))
        self.due += total(self.friction * dot(rows["impulse"], rows["normal"]) *
                          length(slip))

    def advance(self, k):
        """Step k of sheet and point; False: one of them fails, or leaves the ground. The
        point's is one of Baraff–Witkin's as long as the sheet's, or short ones."""
        steps = 1 if self.method.integrator == lib.DRAPE_BW else around(self.dt / FINE)
        if not self.world.step() or not all(
                self.point.step(self.ground, self.friction, self.dt / steps, self.gap)
                for _ in range(steps)):
            return False
        middle, slowest = self.look()
        self.steepest = self.world.steepest(self.steepest)
        report = self.world.report
        # The list has the contacts of the last slice alone, and friction is at its limit
        # only where things slide.
        if report.slices == 1 and slowest > 0.05:
            self.add_work()
        mass = self.sheet.material.density * SIZE * SIZE
        # J/kg, of gravity, and kinetic and elastic, of the sheet and of the point
        now = ((report.potential / mass, (report.kinetic + report.elastic) / mass),
               (G * self.point.x[1], dot(self.point.v, self.point.v) / 2))
        if k == 0:
            self.energy = now
        # the share of gravity's work since then that is neither in motion nor in springs
        sheet_lost, point_lost = (
            1 - np.float64(last[1] - first[1]) / (first[0] - last[0])
            for first, last in zip(self.energy, now))
        self.lost = sheet_lost - point_lost
        if middle is None:
            return False
        self.middle = middle
        if (k + 1) * self.dt < 0.1 + 1e-9:
            self.rested = middle
        return True


def settle(v, ground, start):
    """Where the sheet's particles are after half a second with much friction, which brings
    the sheet to rest: as it was laid, it touches the ground in few places only. None: a
    step failed."""
    t = Slide(v, ground, start, 2, 1 / 60, LINEAR)
    if t.start is None or not all(t.world.step() for _ in range(30)):
        return None
    t.world.read()
    return t.world.x[:COUNT].copy()


def points_way(v, ground, start, friction, rest):
    """The mean way, from and to, of points that start where every second particle of a row
    and a column of the sheet rests, each by itself, on the mesh's own triangles, by short
    steps. Points that come to no end are left out; NaN: more than three do."""
    facets, gap, ends = Facets(ground.mesh.near(start, 0.35)), SIZE / (SIDE - 1) / 4, []
    starts = rest.reshape(SIDE, SIDE, 3)[::2, ::2].reshape(-1, 3)
    for x in starts:
        point = Point(x)
        if all(point.step(facets, friction, FINE, gap)
               for _ in range(around(SECONDS / FINE))):
            ends.append((x, point.x))
    way = []
    for k in range(2):  # at the height of the sheet's middle
        middle = total(np.array([each[k] for each in ends]).reshape(-1, 3) / len(ends))
        put = ground.put(middle, gap)
        way.append(middle if put is None else put)
    if len(ends) < len(starts) - 3:
        way[1] = way[1] * NAN
    return way


def part_of(start, end, went):
    """How much of the way due was gone, and how far aside, over that way."""
    due = end - start
    return dot(due, went) / dot(due, due), length(went - due) / length(due)


# What came of a slide: what it is due, its bar, and its name.
RESULTS = {
    "way": (1, 0.02, "way over a point's"),
    "facets": (1, 0.02, "way over that of points on its facets"),
    "ground": (1, NAN, "way of points on its facets over a point's"),
    "aside": (0, 0.02, "end's distance from the point's; over its way"),
    "law": (1, 0.02, "friction's work over its coefficient times load and slip"),
    "cone": (1, 1e-3, "largest quotient of a contact in a step; over its coefficient"),
    "lost": (0, 0.02, "energy lost over gravity's work; less a point's"),
    "creep": (0, 1e-3, "speed after 0.1 s")}


def slide(v, ground, start, friction, dt, method, rest, way):
    """Slides the sheet and the point side by side, from rest. way: of points on facets,
    from and to. Returns the results; NaN: it failed."""
    out = dict.fromkeys(RESULTS, NAN)
    t = Slide(v, ground, start, friction, dt, method, rest)
    if t.start is None:
        return out
    t.point.x = t.start.copy()
    done = all(t.advance(k) for k in range(around(SECONDS / dt)))
    out["ground"] = part_of(t.start, t.point.x, way[1] - way[0])[0]
    if not done:
        return out
    went = t.middle - t.start
    out["facets"] = part_of(*way, went)[0]
    out["way"], out["aside"] = part_of(t.start, t.point.x, went)
    out["law"] = np.float64(t.work) / t.due
    out["cone"] = np.fmax(1, np.float64(t.steepest) / friction)
    out["lost"] = t.lost
    out["creep"] = length(t.middle - t.rested) / (SECONDS - 0.1)
    return out


class Flank:
    """A ground to slide on: a statue's, or made in code. frictions: how many of the part's,
    from the first; facet, rough: m, of the boulder."""

    def __init__(self, name, frictions, file=None, facet=0, rough=0):
        self.name, self.frictions, self.file = name, frictions, file
        self.facet, self.rough = facet, rough

    def make(self):
        """False: it is not there."""
        mesh = statue_of(self.file, STATUE) if self.file else boulder(self.facet, self.rough)
        if mesh:
            self.ground, self.coarse = Smooth(mesh, SIZE), Smooth(mesh, 1.5 * SIZE)
        return bool(mesh)

    def slide_all(self, v, friction, method, first=0):
        """The values of all paths that are farthest from what is due, by steps, the longest
        of which is number `first`. NaN where a slide fails, or there is no path. And how
        many paths there are."""
        # What rests does so where a sheet with friction 0.2 slides.
        paths = find_paths(self.ground, self.coarse, 0.2 if friction > 1 else friction)
        out = {kind: [due if paths else NAN] * SIZES for kind, (due, *_) in RESULTS.items()}
        for start in paths:
            rest, way = settle(v, self.ground, start), np.zeros((2, 3))
            if rest is not None and method is not LINEAR:
                way = points_way(v, self.ground, start, friction, rest)
            for c in range(first, SIZES):
                one = (dict.fromkeys(RESULTS, NAN) if rest is None else slide(
                    v, self.ground, start, friction, 1 / (60 << c), method, rest, way))
                for kind, (due, *_) in RESULTS.items():
                    kept = out[kind][c]
                    if not math.isnan(kept) and not abs(one[kind] - due) <= abs(kept - due):
                        out[kind][c] = one[kind]
        return out, len(paths)

    def add(self, v, friction, method, found, kind, promised, first=0):
        """A row of one kind of result, by steps from number `first` on."""
        values, paths = found
        due, bar, what = RESULTS[kind]
        few = f"{paths} of {PATHS} paths; " if paths < PATHS else ""
        steps = "steps of 4.2 and 2.1 ms; " if first else ""
        p = everywhere(f"{self.name}; friction {friction:g}; {method.name}{few}{steps}{what}",
                       "m/s" if kind == "creep" else "1", due, bar, promised)
        for c in range(first, SIZES):
            p.add(1 / (60 << c), values[kind][c])
        v.end(p)

    def rows(self, v, friction):
        """All rows with one friction by Baraff–Witkin. Friction's work is promised
        everywhere. Of the smooth boulder its way is, with friction 0.2 by short steps, which
        is all of the small form, and that it rests with 1.5."""
        smooth = not self.file and not self.rough and self.facet > 0.01
        found = self.slide_all(v, friction, LINEAR, 2 if v.quick else 0)
        if smooth and friction == 0.2:
            self.add(v, friction, LINEAR, found, "way", True, 2)
        if v.quick:
            return
        if friction > 1:
            self.add(v, friction, LINEAR, found, "creep", smooth)
            return
        for kind in "way", "aside", "law", "cone", "lost":
            if friction > 0 or kind not in ("law", "cone"):
                self.add(v, friction, LINEAR, found, kind, kind == "law")

    def second_rows(self, v, friction):
        """The ways by BDF2, beside a point on the smooth surface, and where that is rough
        beside points on the mesh, too; and the cones."""
        found, rough = self.slide_all(v, friction, SECOND), self.file or self.rough
        self.add(v, friction, SECOND, found, "way", not rough and self.facet > 0.01)
        for kind in ("facets", "ground") if rough else ():
            self.add(v, friction, SECOND, found, kind, not rough and self.facet > 0.01)
        if friction > 0:  # limits.md: its load is of an earlier evaluation
            self.add(v, friction, SECOND, found, "cone", False)

    def solved_rows(self, v, friction):
        """The way by backward Euler itself, whose loss its linear form has, too."""
        self.add(v, friction, SOLVED, self.slide_all(v, friction, SOLVED), "way", False)


def statue(v):
    if v.quick and v.bits == 32:
        return
    few = v.quick or v.bits == 32
    flanks = (Flank("boulder", 6, facet=0.02),
              Flank("boulder in facets of 8 mm", 1, facet=0.008),
              Flank("rough boulder", 2, facet=0.02, rough=0.5e-3),
              Flank("lion", 3, "lion_20k"), Flank("dragon", 3, "dragon_100k"))
    for flank in flanks[:1 if few else None]:
        if not flank.make():
            print(f"skipped: the statue {flank.file}.ply: it is in no folder of meshes "
                  "(drape fetch-models DIR fetches it; set DRAPE_DATA=DIR)")
            continue
        for k, friction in enumerate((0.2, 0, 1.5, 0.05, 0.5, 1)[
                :1 if few else flank.frictions]):
            flank.rows(v, friction)
            if not few and k < 2:
                flank.second_rows(v, friction)
            if not few and k == 0 and flank.file:
                flank.solved_rows(v, friction)
