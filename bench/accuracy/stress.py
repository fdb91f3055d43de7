# SPDX-License-Identifier: Apache-2.0
"""Scenes at the edge of what a step can do, and how each ends. None may crash or hang, have
an intersection that is not reported, or a number that is not finite. spec/accuracy.md §4"""
import math

import numpy as np
from drape._core import lib

from bench.accuracy.run import EXPLICIT, IMPLICIT, INTEGRATORS, Run, pairs
from bench.accuracy.scenes import ball, plane, scene, sheet


def start(b, side):
    made = scene(b)
    return made, sheet(made, side, 0.5, 0.3)


def add_ball(made, motion=-1):
    made.body(*ball(0.08, (0, 0.2, 0), 16), motion=motion)


def by(made, method):
    """Sets the integrator, with steps that suit an explicit one."""
    made.settings.integrator = method
    if method in EXPLICIT:
        made.settings.dt = 1e-3


def end(b, out, made, name, value, steps):
    """Runs a case and writes its row. An intersection that no step reported is a failed
    check."""
    most, cloths = 0, len(made.cloths)

    def audit(world, _):
        nonlocal most
        most = max(most, pairs(world, cloths))
        return True

    run, s = Run(b, made, steps, audit), made.settings
    b.check(not most or run.outcome & lib.DRAPE_TRAPPED,
            f"{name} {value:g}: {most} pairs intersect and no step said so")
    out.row('%s,%g,%s,%d,%g,%s,%d of %d,%.1f,%.3g,%d,%d,%.3g,"%s"', name, value,
            INTEGRATORS[s.integrator], s.precision, s.dt, run.word, run.steps, steps,
            run.iterations / run.steps if run.steps else 0, run.residual, most,
            run.contacts, run.seconds, run.text)


def mass_ratios(b, out):
    """A sheet falls on a ball, and a sheet of another density falls on the first."""
    for k in (0, 2, 4, 6):
        for upper, word in enumerate(("below", "above")):
            made, _ = start(b, 17)
            add_ball(made)
            sheet(made, 17, 0.5, 0.32)
            made.cloths[upper].material.density = 0.2 * 10**(k / 2)
            made.cloths[1 - upper].material.density = 0.2 / 10**(k / 2)
            end(b, out, made, f"mass ratio heavy {word}", 10**k, 16)


def damping(b, out):
    for method in (*EXPLICIT, *IMPLICIT):
        for k in range(-5, 4, 8 if b.quick else 2):
            made, cloth = start(b, 9)
            by(made, method)
            cloth.material.damping = 10.0**k
            made.settings.max_substeps = 2000
            cloth.pin(0, 0)  # so that falling strains it
            end(b, out, made, "damping in s", 10.0**k, 30)


def shapes(b, out):
    """Strips, grids of oblong cells, and very small and very large cells; some of them the
    library must refuse."""
    grids = ((2, 2, 0.5, 0.5), (2, 400, 0.002, 0.798), (400, 2, 0.8, 0.002),
             (9, 12, 0.5, 0.5), (9, 17, 0.5, 0.5), (9, 90, 0.5, 0.5), (17, 17, 1e-4, 1e-4),
             (17, 17, 1e4, 1e4))
    for m, n, width, height in grids:
        made, cloth = start(b, 9)
        c = cloth.struct
        c.m, c.n, c.width, c.height = m, n, width, height
        cloth.material.thickness = min(2e-3, width)
        if width < 1:
            add_ball(made)
        end(b, out, made, f"grid {m} x {n} of {width:g} m x {height:g} m",
            (width / (m - 1)) / (height / (n - 1)), 30)


def coincident(b, out):
    """Particles that coincide: one spring, a row, all of them in one point."""
    p = np.arange(81)
    places = (("one spring of length 0", np.where(p == 41, 40, p)),
              ("two rows coincide", np.where(p < 18, p % 9, p)),
              ("all in one point", 0 * p))
    for kind, (name, q) in enumerate(places):
        for method in (*EXPLICIT, *IMPLICIT):
            if b.quick and method % 3 != kind:
                continue
            made, cloth = start(b, 9)
            by(made, method)
            made.settings.allow_intersecting = 1
            made.settings.self_collision = 0  # else the start intersects itself
            cloth.x = np.stack([0.0625 * (q % 9), 0 * q + 0.3, 0.0625 * (q // 9)], 1)
            cloth.pin(0, 0)
            end(b, out, made, name, kind, 30)


def fast_obstacle(b, out):
    """A ball that crosses the sheet, or half of it, in one step."""
    methods = (lib.DRAPE_BW, lib.DRAPE_BW, lib.DRAPE_CK, lib.DRAPE_VERLET)
    for k, method in enumerate(methods):
        if b.quick and k:
            return
        made, _ = start(b, 17)
        made.settings.integrator = method
        way = 0.25 if k % 2 else 0.5  # m a step, sheets of 0.5 m
        add_ball(made, made.keys([0, 20 * made.settings.dt],  # at the sheet's height
                                 [(-1, 0.1, 0), (20 * way - 1, 0.1, 0)]))
        end(b, out, made, "fast ball: m a step", way, 20)


def twist(b, out, turns):
    """A strip whose ends rotate in opposite directions about the x axis, by about half a
    turn a second, and move towards x = 0 by a tenth of their way a second."""
    made, cloth = start(b, 13)
    s, c, times = made.settings, cloth.struct, range(turns + 1)
    s.gravity[1], s.dt = 0, 1 / 120
    c.m, c.width, c.height = 49, c.width * 1.2, c.height * 0.3
    c.origin[0], c.origin[2] = -c.width / 2, -c.height / 2
    for k in range(2):
        side, way = (k - 0.5) * c.width, (1 if k else -1)
        angles = [way * t * 3.14159265358979 / 2 * 0.98 for t in times]
        made.keys(times, [(side * (1 - 0.1 * t), 0.3, 0) for t in times],
                  [(math.cos(a), math.sin(a), 0, 0) for a in angles], (side, 0.3, 0))
        for j in range(c.n):
            cloth.pin(k * (c.m - 1), j, k)
    end(b, out, made, "twist: turns", turns, 120 * turns)


def layers(b, out):
    """Eight sheets, one above the other, that fall on each other."""
    made = scene(b)
    made.body(*plane(2))
    for k in range(8):
        sheet(made, 13, 0.4, 0.003 + 0.004 * k)
    end(b, out, made, "layers", 8, 12)


def slivers(b, out):
    """An obstacle of slivers: the ball squeezed along y, with some triangles that have no
    area."""
    for k in range(0, 13, 12 if b.quick else 4):
        made, _ = start(b, 17)
        x, tri = ball(0.08, (0, 0.2, 0), 16)
        x[:, 1] = 0.2 + (x[:, 1] - 0.2) * 10.0**-k
        tri[:20, 2] = tri[:20, 1]
        made.body(x, tri)
        end(b, out, made, "slivers: height by width", 10.0**-k, 20 if b.quick else 40)


def stress(b):
    with b.table("stress", "case,value,integrator,precision,dt,end,steps,iterations a step,"
                 "worst residual,intersecting pairs,contacts,seconds,text") as out:
        for case in (damping, coincident, fast_obstacle, slivers):
            case(b, out)
        if not b.quick:
            for turns in (2, 4, 6):
                twist(b, out, turns)
            for case in (shapes, mass_ratios, layers):
                case(b, out)
