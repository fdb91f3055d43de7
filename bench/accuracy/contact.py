# SPDX-License-Identifier: Apache-2.0
"""Friction, momentum and energy in contact, and how a drape changes with dt and grid.
spec/accuracy.md §5"""
import math

import numpy as np
from drape._core import lib

from bench.accuracy.run import EXPLICIT, IMPLICIT, INTEGRATORS, Run, distance, pairs
from bench.accuracy.scenes import ball, scene, sheet
from validate.world import G, around, total


def slope_scene(b, slope, friction):
    """A sheet at rest on one large triangle: the edge between two would push sideways."""
    made = scene(b)
    cloth, out = sheet(made, 9, 0.2, 0), (math.sin(slope), math.cos(slope), 0)
    made.body([(a * math.cos(slope), -a * math.sin(slope), z)
               for a, z in ((-9, -9), (27, -9), (-9, 27))], [(0, 2, 1)], friction)
    c = cloth.struct
    c.u[0], c.u[1] = math.cos(slope), -math.sin(slope)
    for k in range(3):  # just closer than the thickness
        c.origin[k] = -0.1 * c.u[k] - 0.1 * c.v[k] + 0.0019 * out[k]
    cloth.material.friction = friction
    made.settings.sleep = 0
    return made, cloth


def steps_way(integrator, n):
    """The way of n steps from rest under a constant acceleration a, in units of a dt²: the
    integrator's own. spec/cloth/implicit.md §5"""
    if integrator == lib.DRAPE_BW:
        return n * (n + 1) / 2
    return n * n / 2 + 0.75 * (1 - 3.0**-n)


def slide(b, out, tangent, friction, integrator, part):
    """Compares with Coulomb's law: the sheet rests below the cone's slope, and accelerates
    with g (sin - μ cos) above it, by the integrator's steps of 1/60 s / part."""
    angle, n = math.atan(tangent), (15 if b.quick else 60) * part
    made, cloth = slope_scene(b, angle, friction)
    s, c = made.settings, cloth.struct
    s.tolerance, s.integrator, s.dt = 1e-3, integrator, 1 / 60 / part
    run = Run(b, made, n)
    way = total(((run.x[:81] - list(c.origin)) * list(c.u) / 81).ravel()) - 0.1
    a = max(0, G * (math.sin(angle) - friction * math.cos(angle)))
    due = a * s.dt * s.dt * steps_way(integrator, float(n))
    out.row("%g,%g,%s,%.4g,%g,%.6g,%.6g,%.3g,%.1f,%s", tangent, friction,
            INTEGRATORS[integrator], s.dt, s.tolerance, way, due, way - due,
            run.iterations / n, run.word)
    # The error allowed by spec/accuracy.md §5: twice the tolerance of the solve, of the
    # distances that gravity and friction alone would give, since the distance may be a
    # small difference of the two; and 1/2 mm/s.
    t = n * s.dt
    pull, rub = G * math.sin(angle) * t * t / 2, G * friction * math.cos(angle) * t * t / 2
    creep = 5e-4 * t if friction > 0 else 0
    b.check(abs(way - due) <= 2 * s.tolerance * (pull + rub) + creep,
            f"slope {tangent}, friction {friction}, {INTEGRATORS[integrator]}: {way:g} m, "
            f"Coulomb {due:g} m")


def friction(b):
    with b.table("friction", "slope,friction,integrator,dt,tolerance,way m,Coulomb m,"
                 "difference m,iterations a step,end") as out:
        for integrator in IMPLICIT:
            for mu in (0, 0.2, 0.55, 0.8) if b.quick else (0, 0.2, 0.45, 0.55, 0.8):
                for tangent in (0.25, 0.5, 0.75):
                    for part in (1,) if b.quick else (1, 16):
                        slide(b, out, tangent, mu, integrator, part)


def collide(b, out, integrator, ratio, dt, tolerance):
    """Two sheets collide in empty space. Energy that the response creates shows as a rise,
    since nothing else adds energy."""
    side, speed, made = 17, 1, scene(b)
    n, s = side * side, made.settings
    edge = np.where(np.arange(side) % (side - 1) == 0, 0.5, 1)
    weights = []
    for k in range(2):
        cloth = sheet(made, side, 0.4, 0.02 * k)
        cloth.struct.origin[0] += 0.13 * k
        cloth.material.density = 0.2 * ratio if k else 0.2
        cloth.v = np.zeros((n, 3))
        cloth.v[:, 1] = -speed / ratio if k else speed
        mass = cloth.material.density * 0.16 / ((side - 1) * (side - 1))
        weights.append(mass * edge[cloth.i] * edge[cloth.j])
    weights = np.concatenate(weights)[:, None]
    before = total(weights * np.concatenate([cloth.v for cloth in made.cloths]))
    s.gravity, s.sleep = [0, 0, 0], 0
    s.integrator, s.tolerance, s.dt = integrator, tolerance, dt
    energies, found = [], []

    def add(world, report):
        energies.append(report.kinetic + report.elastic)
        found.append(pairs(world, 2))
        return True

    run = Run(b, made, around(0.1 / dt), add)
    rise, end, met = max(0, np.diff(energies).max()), energies[-1], sum(found)
    lost = np.abs((total(weights * run.v[:2 * n]) - before) / (0.2 * 0.16 * speed)).max()
    first = 0.5 * 0.2 * 0.16 * speed * speed * (1 + 1 / ratio)
    name = INTEGRATORS[integrator]
    out.row("%s,%g,%.4g,%g,%.3g,%.3g,%.3g,%d,%d,%d,%s", name, ratio, dt, tolerance, lost,
            rise / first, end / first, run.contacts, run.impacts, met, run.word)
    about = f"two sheets, {name}, ratio {ratio:g}, dt {dt:g}"
    b.check(met == 0, f"{about}: {met} pairs intersect")
    b.check(end <= first * (1 + 1e-4), f"{about}: energy {end / first:g} of 1 at the end")
    # Longer steps strain the sheets, so their rise is only written down.
    implicit = integrator in IMPLICIT
    fine = dt < (5e-3 if implicit else 1.1e-3)
    b.check(not fine or rise <= (1e-5 if implicit else 2e-3) * first,
            f"{about}: energy rises by {rise / first:g}")
    b.check(not fine and not implicit or lost <= 1e-5, f"{about}: {lost:g} of p is lost")


def collisions(b):
    with b.table("collide", "integrator,mass ratio,dt,tolerance,momentum lost,largest rise "
                 "of energy,energy at the end,contacts,impacts,intersecting pairs,end"
                 ) as out:
        if b.quick:
            for integrator in (lib.DRAPE_RK4, *IMPLICIT):
                for ratio in (1, 100):
                    collide(b, out, integrator, ratio, 1 / 60 / 4, 1e-3)
            return
        for integrator in (*EXPLICIT, *IMPLICIT):
            implicit = integrator in IMPLICIT
            for ratio in (1, 100, 10000):
                for part in (1, 4, 16) if implicit else (16,):
                    for tolerance in (1e-3, 1e-6) if implicit else (1e-3,):
                        collide(b, out, integrator, ratio, 1 / 60 / part, tolerance)


def refine(b):
    with b.table("refine", "side,dt,mean height m,lowest m,own energy J,"
                 "rms m to the last dt,seconds,end") as out:
        for side in (17, 33, 65):
            last = None
            for part in (1, 2) if side == 65 else (1, 2, 4):
                made, n = scene(b), side * side
                cloth = sheet(made, side, 0.8, 0.53)
                cloth.material.thickness, cloth.material.bend = 0.004, 1e-3
                made.body(*ball(0.2, (0, 0.3, 0), 48))
                made.settings.dt = 1 / 60 / part
                run = Run(b, made, around(1 / made.settings.dt))
                y = run.x[:n, 1]
                out.row("%d,%.5g,%.5f,%.5f,%.4g,%.3g,%.3g,%s", side, made.settings.dt,
                        total(y / n), y.min(), run.own,
                        distance(run, last, n) if last else 0, run.seconds, run.word)
                last = run


def contact(b):
    friction(b)
    collisions(b)
    if not b.quick:
        refine(b)
