# SPDX-License-Identifier: Apache-2.0
"""Sheets on sheets. spec/validation.md §13"""
import math
from dataclasses import dataclass, replace

import numpy as np
from drape._core import lib

from validate.property import everywhere, measure, slope
from validate.scheme import PLAIN, Scheme, schemes
from validate.world import G, NAN, Scene, around

STEPS = 1 / 60, 1 / 240


def tilt(scene, degrees):
    a = degrees * math.pi / 180
    gravity = scene.settings.gravity
    gravity[0], gravity[1] = G * math.sin(a), -G * math.cos(a)


def pull(degrees, friction):
    """What pulls a block down the slope, m/s²."""
    a = degrees * math.pi / 180
    return G * (math.sin(a) - friction * math.cos(a))


def way_of(how, speed, a, span, dt):
    """The way in a time from this speed on, by steps of the scheme: backward Euler's sum
    of speeds, or that of second order."""
    first = how.integrator == lib.DRAPE_BW
    return speed * span + a * span * (span + (dt if first else 0)) / 2


# What is asked of a stack, by the name of what is measured: what it is, its unit, theory
# and bar.
ASKED = {"way": ("farthest way", "m", 0, 1e-3),
         "speed": ("largest speed at the end", "m/s", 0, 1e-3),
         "law": ("way over Coulomb's", "1", 1, 0.02),
         "load": ("floor's share of all weights", "1", 1, 0.01),
         "least": ("share of a sheet in what lies on it", "1", 1, 0.01),
         "height": ("least distance of two sheets; of the thickness", "1", 1, 0.1)}


@dataclass
class Stack:
    """Sheets one above the other, a thickness apart, moved by `apart` m in turn. side:
    particles; heavy: the uppermost's density, times the others'.

    What is measured: way: the farthest mean way of a sheet, m; speed: the largest at the
    end, m/s; law: over Coulomb's way of a block, the value that is farthest from 1; load:
    the floor's share of all weights; least: the worst share of a layer in what lies on it;
    height: the least distance of two means, of the thickness; iterations: a step."""
    sheets: int = 2
    side: int = 11
    cell: float = 0.02
    degrees: float = 0
    friction: float = 0.3
    apart: float = 0.0037
    heavy: float = 1
    how: Scheme = PLAIN
    dt: float = 1 / 60
    time: float = 1

    def make(self, v):
        scene = Scene(v, self.how, self.dt)
        tilt(scene, self.degrees)
        scene.material.friction = self.friction
        thick = min(scene.material.thickness, self.cell / 2)
        for k in range(self.sheets):
            if k == self.sheets - 1:
                scene.material.density *= self.heavy
            scene.sheet(self.side, self.side, self.cell,
                        (self.apart * (k % 3), thick * (k + 1), self.apart / 2 * (k % 2)))
        scene.floor(self.friction)
        return scene

    def add_loads(self, found, load):
        """Adds what presses from the layer below on each body: [k] is what sheet k gets
        from below, upward."""
        contacts, _, dt = found
        n = self.sheets
        for (upper, lower), impulse in zip(contacts["body"].tolist(),
                                           contacts["impulse"][:, 1].tolist()):
            if lower < n and (upper >= n or lower > upper):
                upper, lower, impulse = lower, upper, -impulse
            if upper < n and upper != lower:
                load[upper] += impulse / dt

    def run(self, v, last=10):
        self.way = self.speed = self.law = self.load = self.least = NAN
        self.height = self.iterations = NAN
        steps, first = around(self.time / self.dt), around(0.1 / self.dt)
        scene = self.make(v)
        world, load = scene.world(), [0] * self.sheets
        if not world:
            return
        start = [world.mean(s, world.x) for s in scene.cloths]
        for k in range(1, steps + 1):
            if not world.goes():
                return
            if k > steps - last:
                self.add_loads(world.contacts(), load)
            if k == first:
                early = [(world.mean(s, world.x)[0], world.mean(s, world.u)[0])
                         for s in scene.cloths]
        self.iterations = world.iterations / steps
        self.judge_loads(scene, load, last)
        self.judge_ways(scene, world, start, early, (steps - first) * self.dt)

    def judge_loads(self, scene, load, last):
        above, self.least = 0, 1
        due = G * math.cos(self.degrees * math.pi / 180)
        for s in reversed(scene.cloths):
            above += due * s.mass
            self.load = load[s.number] / last / above  # at last the floor's
            if abs(self.load - 1) > abs(self.least - 1):
                self.least = self.load

    def judge_ways(self, scene, world, start, early, span):
        self.way, self.speed, self.law, self.height, below = 0, 0, 1, math.inf, 0
        a = pull(self.degrees, self.friction)
        for s in scene.cloths:
            to, u = world.mean(s, world.x), world.mean(s, world.u)
            at, speed = early[s.number]
            self.way = np.fmax(self.way, np.hypot(to[0] - start[s.number][0],
                                                  to[2] - start[s.number][2]))
            self.speed = np.fmax(self.speed, np.hypot(u[0], u[2]))
            law = (to[0] - at) / way_of(self.how, speed, a, span, self.dt)
            if not abs(law - 1) < abs(self.law - 1):
                self.law = law
            self.height = np.fmin(self.height, (to[1] - below) / s.thickness)
            below = to[1]


def stack_rows(v, name, stack, kinds, sizes=STEPS, cells=False):
    """Rows of a stack at several sizes: of steps, or of cells."""
    rows = [everywhere(f"{name}; {what}", *about)
            for what, *about in (ASKED[kind] for kind in kinds)]
    side = stack.cell * (stack.side - 1)
    for size in sizes:
        one = (replace(stack, cell=size, side=around(side / size) + 1) if cells else
               replace(stack, dt=size))
        one.run(v)
        for p, kind in zip(rows, kinds):
            p.add(size, getattr(one, kind))
    for p in rows:
        v.end(p)


def slopes(v):
    """Stacks on slopes: they rest, or slide as a block."""
    kinds = (12, ("way", "speed"), 1), (25, ("law",), 0.6)
    for n in (2, 8) if v.quick else (1, 2, 4, 8):
        for degrees, what, time in kinds:
            stack_rows(v, f"{n} sheets at {degrees} degrees",
                       Stack(n, degrees=degrees, time=0.6 if v.quick else time), what,
                       STEPS[:1 if v.quick else 2])
    for degrees, what, time in () if v.quick else kinds:
        title = f"2 sheets at {degrees} degrees"
        stack = Stack(degrees=degrees, time=time)
        for how in schemes(v)[1:]:
            stack_rows(v, f"{title}; {how.name}", replace(stack, how=how), what)
        stack_rows(v, f"{title}; by cells", stack, what, (0.02, 0.01, 0.005), True)
        stack_rows(v, f"{title}; particle on particle", replace(stack, apart=0), what)


def weights(v):
    """Weights and heights of stacks on a level floor, and work over the number of
    sheets."""
    kinds, work = ("load", "least", "height"), {}
    for n in (4, 16) if v.quick else (1, 2, 4, 8, 16, 32):
        stack = Stack(n, side=7)
        stack.run(v)
        for kind in *kinds, "iterations":
            what, *about = ASKED.get(kind, ("iterations a step", "1", 0, NAN))
            p = everywhere(f"{n} sheets; {what}", *about)
            p.add(stack.cell, getattr(stack, kind))
            v.end(p)
        work[n] = np.fmax(1, stack.iterations)
    if v.quick:
        return
    p = everywhere("iterations a step from 2 to 32 sheets; exponent; from 1 on", "1", 1,
                   0.05)
    p.add(Stack.cell, np.fmax(1, slope(list(work)[1:], list(work.values())[1:])))
    v.end(p)
    for heavy in 10, 100:
        stack_rows(v, f"3 sheets; the uppermost {heavy} times as heavy",
                   Stack(3, heavy=heavy), kinds)
    stack_rows(v, "5 sheets; particle on particle", Stack(5, apart=0, time=2), kinds[2:])


def held(v, degrees, how, dt):
    """The way of a sheet on a sheet that lies on the floor and is held at its upper
    border; over Coulomb's where it slides."""
    scene = Scene(v, how, dt)
    tilt(scene, degrees)
    lower = scene.sheet(31, 21, 0.02, (-0.05, 0.002, -0.05))
    upper = scene.sheet(11, 11, 0.02, (0.0037, 0.004, 0.0021))
    for j in range(21):
        lower.pin(0, j)
    scene.floor(0.3)
    world = scene.world()
    if not world or not world.until(0.1):
        return NAN
    start, speed = world.mean(upper, world.x)[0], world.mean(upper, world.u)[0]
    if not world.until(0.5):
        return NAN
    way, a = world.mean(upper, world.x)[0] - start, pull(degrees, 0.3)
    return way / way_of(how, speed, a, 0.4, dt) if a > 0 else way


def upper_sheets(v):
    for how in schemes(v):
        for degrees, kind in (15, "way"), (25, "law"):
            what, *about = ASKED[kind]
            measure(v, [everywhere(f"a sheet on a held one at {degrees} degrees; {how.name}; "
                                   f"{what}", *about, degrees == 15)], STEPS,
                    lambda dt, at=degrees, how=how: held(v, at, how, dt))


def folded(v, aside, dt, cell=0.005):
    """A sheet that is folded once on itself, with a bend of 10 mm across; its length goes
    down the slope, or across it. Way after a second in which it settles, and speed."""
    radius, half = 0.005, 0.1
    scene = Scene(v, PLAIN, dt)
    tilt(scene, 6)
    scene.material.thickness = 0.001
    bend = math.pi * radius
    m, n = around((2 * half + bend) / cell) + 1, around(0.1 / cell) + 1
    sheet = scene.sheet(m, n, cell)
    for k, x in enumerate(sheet.x):
        s, z = cell * (k % m), cell * (k // m)
        turn, back = (s - half) / radius, s - half - bend
        at = (s if s < half else half - back if back > 0 else
              half + radius * math.sin(turn))
        up = (0 if s < half else 2 * radius if back > 0 else
              radius * (1 - math.cos(turn)))
        x[:] = z if aside else at, 0.001 + up, at if aside else z
    scene.floor(0.3)
    world = scene.world()
    if not world or not world.until(1):
        return NAN, NAN
    start = world.mean(sheet, world.x)
    if not world.until(2):
        return NAN, NAN
    to, u = world.mean(sheet, world.x), world.mean(sheet, world.u)
    return np.hypot(to[0] - start[0], to[2] - start[2]), np.hypot(u[0], u[2])


def folds(v):
    for aside in False, True:
        title = f"a fold at 6 degrees; its line {'along' if aside else 'across'} the slope; "
        measure(v, [everywhere(f"{title}way in 1 s", "m", 0, 1e-3),
                    everywhere(f"{title}{ASKED['speed'][0]}", "m/s", 0, 1e-3)],
                STEPS[:1 if v.quick else 2], lambda dt, aside=aside: folded(v, aside, dt))


def pulled(v, friction, dt):
    """A cloth is pulled at 1 m/s from under a stiff napkin. Returns how far the napkin
    went, m; and its largest speed, over what friction allows since the start."""
    scene = Scene(v, PLAIN, dt)
    scene.material.friction = friction
    cloth = scene.sheet(41, 11, 0.02, (-0.4, 0.002, -0.1))
    scene.material.bend = 1e-2
    napkin = scene.sheet(9, 9, 0.01, (-0.1631, 0.004, -0.037))
    scene.floor(friction)
    motion = scene.motion(0.2, 0.6, 0.05, (1, 0, 0))
    for j in range(11):
        cloth.pin(40, j, motion)
    world, most = scene.world(), 0
    if not world or not world.until(0.2):
        return NAN, NAN
    start = world.mean(napkin, world.x)
    while world.steps * dt < 0.3:
        if not world.goes():
            return NAN, NAN
        u, time = world.mean(napkin, world.u), world.steps * dt - 0.2
        if time > 0.05:
            most = np.fmax(most, np.hypot(u[0], u[2]) / np.float64(friction * G * time))
    at = world.mean(napkin, world.x)
    return np.hypot(at[0] - start[0], at[2] - start[2]), most


def tablecloth(v):
    title = "a cloth pulled from under a napkin; "
    rows = [everywhere(f"{title}no friction; way", "m", 0, 1e-3, False),
            everywhere(f"{title}friction 0.2; speed over mu g t", "1", 1, 0.05, False)]
    measure(v, rows, STEPS, lambda dt: (pulled(v, 0, dt)[0], pulled(v, 0.2, dt)[1]))


def layers(v):
    if v.quick and v.bits == 32:
        return
    slopes(v)
    weights(v)
    folds(v)
    if v.quick:
        return
    upper_sheets(v)
    stack_rows(v, "3 sheets without friction", Stack(3, 21, friction=0, apart=1e-3, time=3),
               ("way",))
    tablecloth(v)
