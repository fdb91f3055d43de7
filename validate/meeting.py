# SPDX-License-Identifier: Apache-2.0
"""Two sheets that meet. spec/validation.md §9"""
from dataclasses import dataclass

import numpy as np
from drape._core import lib

from validate.property import SIZES, everywhere
from validate.world import NAN, Scene, around, cross, dot, total


@dataclass
class Manner:
    """How two sheets move. promised: energy and linear momentum."""
    name: str
    integrator: int
    newton: int
    slices: int = 32
    promised: bool = True


MANNERS = (Manner("baraff-witkin", lib.DRAPE_BW, 1),
           Manner("baraff-witkin with newton 8", lib.DRAPE_BW, 8),
           Manner("bdf2", lib.DRAPE_BDF2, 4))
# Every step whole, as the list of contacts is that of the last slice.
WHOLE = Manner("", lib.DRAPE_BW, 1, 1)


def momentum(mass, x, u):
    """Momentum, and the angular one about the origin."""
    return total(mass[:, None] * u), total(mass[:, None] * cross(x, u))


def meet(v, h, ratio, how, dt):
    """Two sheets of 0.4 m, 15 mm apart and 0.1 m aside, meet at 1 m/s each in empty
    space, for 0.2 s: the upper one is `ratio` times as heavy and as slow. Returns the
    largest energy of a step over the start's; linear and angular momentum lost, as a
    share; and the torque of the contacts, as a share of the angular one, NaN if a step
    was cut into slices: impulses act where the step began."""
    m = around(0.4 / h) + 1
    scene = Scene(v, how, dt)
    settings = scene.settings
    settings.self_collision, settings.max_slices = 1, how.slices
    settings.tolerance = 1e-7 if v.bits == 64 else 1e-5
    settings.gravity = [0, 0, 0]
    masses = []
    for upper in 0, 1:
        s = scene.sheet(m, m, h)
        s.x[:, 0] = h * s.i + 0.1 * upper - 0.2
        s.x[:, 1] = 0.015 * upper
        s.x[:, 2] = h * s.j - 0.2
        s.v[:, 1] = -1 / ratio if upper else 1
        s.material.density *= ratio if upper else 1
        mass = np.full(m * m, 0.2 * (ratio if upper else 1) * h * h)
        for of in s.i, s.j:
            mass *= np.where((of == 0) | (of == m - 1), 0.5, 1)
        masses.append(mass)
    mass = np.concatenate(masses)
    x, u = (np.concatenate([getattr(s, of) for s in scene.cloths]) for of in "xv")
    start = total(mass * u[:, 1] * u[:, 1] / 2)
    world = scene.world()
    if not world:
        return (NAN,) * 4
    before = momentum(mass, x, u)
    most, torque, uncut = 1, np.zeros(3), True
    for _ in range(around(0.2 / dt)):
        good = world.step()
        report = world.report
        energy = report.kinetic + report.elastic if good else NAN
        most = most if energy / start <= most else energy / start
        found = world.contacts()
        uncut = uncut and report.slices <= 1 and found is not None
        if uncut:
            rows = found[0]
            for one, apart in zip(rows["impulse"],
                                  (rows["weight"][:, :, None] * x[rows["vertex"]]).sum(1)):
                torque += cross(apart, one)
        world.read()
        x, u = world.x.copy(), world.u.copy()
    after = momentum(mass, x, u)
    lost, turned = after[0] - before[0], after[1] - before[1]
    turn = dot(before[1], before[1])
    return (most, np.sqrt(dot(lost, lost)) / (0.2 * 0.16),
            np.sqrt(dot(turned, turned) / turn),
            np.sqrt(dot(torque, torque) / turn) if uncut else NAN)


def kept(v, sheets, how, sizes, found, everywhere_angular=True):
    """What two sheets keep, at several sizes of cells or of steps."""
    least = 1e-3 if v.bits == 64 else 0.01
    rows = [everywhere(f"two sheets; {sheets}; {what}", "1", theory, bar, promised)
            for what, theory, bar, promised in (
                ("largest energy over the start's", 1, least, how.promised),
                ("linear momentum lost", 0, least, how.promised),
                # momentum.md §3.4
                ("angular momentum lost", 0, 0.01, how.newton > 1))]
    if not everywhere_angular:
        rows[2].up_to = 0
    for size in sizes:
        for p, value in zip(rows, found(size)):
            p.add(size, value)
    for p in rows:
        v.end(p)


def meeting(v):
    if v.quick:
        return
    cells = (0.04, 0.02, 0.4 / 30, 0.01)[:SIZES if v.bits == 64 else SIZES - 1]
    for ratio in 1, 10:
        for how in MANNERS[:3 if ratio == 1 and v.bits == 64 else 1]:
            kept(v, f"{ratio} to 1; {how.name}", how, cells,
                 lambda h, ratio=ratio, how=how: meet(v, h, ratio, how, 1 / 60))
    if v.bits == 32:
        return
    for how in MANNERS:
        kept(v, f"1 to 1; {how.name}; by steps", how,
             [1 / per for per in (60, 120, 240, 480)],
             lambda dt, how=how: meet(v, cells[0], 1, how, dt), False)
    for ratio in 1, 10:  # what contacts take by themselves
        p = everywhere(f"two sheets; {ratio} to 1; angular momentum that contacts take",
                       "1", 0, 0.01)
        for h in cells:
            p.add(h, meet(v, h, ratio, WHOLE, 1 / 60)[3])
        v.end(p)
