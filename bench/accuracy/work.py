# SPDX-License-Identifier: Apache-2.0
"""Run time against error, without contact; what further linear systems of Newton's method
cost and leave; and the same on both backends. spec/accuracy.md §1"""
import math

import numpy as np
from drape._core import lib

from bench.accuracy.run import (BACKENDS, EXPLICIT, IMPLICIT, INTEGRATORS, PRECONDS, Run,
                                converged, distance)
from bench.accuracy.scenes import Sample
from validate.world import around, dot, total

TIME = 0.1  # s, length of a run: 6 steps of 1/60 s
# Precision, preconditioner and tolerance of the implicit curves; the first is the default.
CURVES = ((32, lib.DRAPE_MULTIGRID, 1e-3), (32, lib.DRAPE_MULTIGRID, 1e-2),
          (32, lib.DRAPE_MULTIGRID, 1e-5), (32, lib.DRAPE_JACOBI, 1e-2),
          (32, lib.DRAPE_JACOBI, 1e-3), (32, lib.DRAPE_JACOBI, 1e-5),
          (64, lib.DRAPE_MULTIGRID, 1e-3), (64, lib.DRAPE_MULTIGRID, 1e-8))
WORK = ("scene,backend,integrator,precision,precond,tolerance,dt,steps,substeps,iterations,"
        "seconds,rms m,max m,energy J,strain,pin m,end")


def length(a, b):
    return np.sqrt(dot(a - b, a - b))


def errors(sample, run, exact):
    """The errors of positions, m (root mean square and largest), of energy, J, of the
    strain of the grid's edges, and the largest distance of a pin from its place, m."""
    cloth, side, n = sample.cloth, sample.cloth.m, sample.cloth.count
    p = np.repeat(np.arange(n), 2)
    q = p + np.tile([1, side], n)
    edge = np.where(q == p + 1, q % side != 0, q < n)
    p, q = p[edge], q[edge]
    d = length(run.x[p], run.x[q]) - length(exact.x[p], exact.x[q])
    d *= side - 1  # to a strain: an edge is 1 / (side - 1) m long
    pins = [i + side * j for i, j, _ in cloth.pins]
    return (distance(run, exact, n), length(run.x[:n], exact.x[:n]).max(),
            abs(run.energy - exact.energy), math.sqrt(total(d * d) / len(d)),
            length(run.x[pins], cloth.x[pins]).max())


def point(b, out, name, sample, exact, steps):
    s = sample.settings
    s.dt = TIME / steps
    implicit = s.integrator in IMPLICIT
    run = Run(b, sample, steps)
    row = "%s,%s,%s,%d,%s,%g,%.9g,%d,%d,%d,%.4g," % (
        name, BACKENDS[b.backend], INTEGRATORS[s.integrator], s.precision,
        PRECONDS[s.precond] if implicit else "", s.tolerance if implicit else 0, s.dt,
        steps, run.substeps, run.iterations, run.seconds)
    if run.good and run.steps == steps:
        row += "%.3e,%.3e,%.3e,%.3e,%.3e," % errors(sample, run, exact)
    else:
        row += ",,,,,"
    out.row(row + run.word)


def curves(b, out, name, sample, exact):
    s = sample.settings
    for s.integrator in EXPLICIT:
        for s.precision in (32, 64):
            for steps in (6,) if b.quick else (6, 384, 768, 1536, 3072):
                point(b, out, name, sample, exact, steps)
    for s.integrator in IMPLICIT:
        for s.precision, s.precond, s.tolerance in CURVES:
            for k in range(2 if b.quick else 6):
                point(b, out, name, sample, exact, 6 << k)


def work(b):
    with b.table("work", WORK) as out:
        for name in ("stretched",) if b.quick else ("stretched", "hanging", "flag"):
            sample = Sample(b, name, 9 if b.quick else 25)
            sample.cloth.material.damping = 1e-3
            exact, off = converged(b, sample, TIME, 768 if b.quick else 6144)
            out.row("%s,%s,converged,64,,,,,,,%.4g,%.3e,,,,,", name, BACKENDS[b.backend],
                    exact.seconds, off)
            curves(b, out, name, sample, exact)


SYSTEMS = (1, 2, 3, 4, 5, 8, 16)
SHORT = 0.5  # s, of a run of newton.csv: 30 steps of 1/60 s


def system_curves(b, out, kind, sample, exact):
    s = sample.settings
    s.precision = 32
    for s.integrator in (lib.DRAPE_BW, lib.DRAPE_BDF2):  # Choi–Ko with more is BDF2
        for steps in (30,) if b.quick else (30, 120, 480):
            s.dt = SHORT / steps
            error = []
            for s.newton in SYSTEMS:
                run = Run(b, sample, steps)
                error.append(distance(run, exact, sample.cloth.count))
                out.row("%s,%s,%d,%.9g,%d,%d,%d,%.4g,%.3e,%s", kind,
                        INTEGRATORS[s.integrator], s.newton, s.dt, run.slices, run.solves,
                        run.iterations, run.seconds, error[-1], run.word)
                # One system may be as near by chance.
                b.check(s.newton < 5 or s.integrator != lib.DRAPE_BDF2 or steps > 30 or
                        error[-1] <= 1.05 * error[0],
                        f"{kind}: {s.newton} systems are further off than one")


def newton(b):
    """The default of drape_def.newton is read off here."""
    scenes = (("swinging", 0), ("falling", 1e-3), ("hanging", 1e-3))
    with b.table("newton", "scene,integrator,newton,dt,slices,solves,iterations,seconds,"
                 "rms m,end") as out:
        for kind, damping in scenes[:1] if b.quick else scenes:
            sample = Sample(b, kind, 9 if b.quick else 17)
            sample.cloth.material.damping = damping
            exact, _ = converged(b, sample, SHORT, 2048 if b.quick else 8192)
            system_curves(b, out, kind, sample, exact)


# Integrator, steps and tolerance of settings that both backends run.
BOTH = ((lib.DRAPE_EULER, 6, 1e-3), (lib.DRAPE_VERLET, 6, 1e-3), (lib.DRAPE_BW, 6, 1e-2),
        (lib.DRAPE_BW, 24, 1e-2), (lib.DRAPE_BW, 96, 1e-2), (lib.DRAPE_BW, 6, 1e-3),
        (lib.DRAPE_BW, 24, 1e-3), (lib.DRAPE_BW, 96, 1e-3), (lib.DRAPE_CK, 6, 1e-3),
        (lib.DRAPE_CK, 24, 1e-3), (lib.DRAPE_CK, 96, 1e-3), (lib.DRAPE_CK, 192, 1e-3))


def on_both(b, out, sample, exact):
    """Rows of one setting; the bits must be equal, and so the errors."""
    s, runs = sample.settings, []
    for b.backend in (lib.DRAPE_REF, lib.DRAPE_GPU):
        run = Run(b, sample, around(TIME / s.dt))
        out.row("%d,%s,%s,%d,%g,%.6g,%d,%d,%.4g,%.3e,%s", sample.cloth.m,
                BACKENDS[b.backend], INTEGRATORS[s.integrator], s.precision,
                s.tolerance if s.integrator in IMPLICIT else 0, s.dt, run.substeps,
                run.iterations, run.seconds, distance(run, exact, sample.cloth.count),
                run.word)
        runs.append(run)
    b.check(all(run.x is not None for run in runs) and
            runs[0].x.tobytes() == runs[1].x.tobytes(),
            f"{sample.cloth.m} particles a side, {INTEGRATORS[s.integrator]}: the "
            "backends differ")


def grid(b, out, side, fine):
    """All settings on one grid; on a fine grid only the implicit ones, since explicit ones
    take too many substeps for the reference."""
    sample = Sample(b, "hanging", side)
    sample.cloth.material.damping = 1e-3
    s = sample.settings
    b.backend = lib.DRAPE_GPU
    exact, off = converged(b, sample, TIME, fine)
    out.row("%d,gpu,converged,64,,%.6g,,,%.4g,%.3e,", side, s.dt, exact.seconds, off)
    for s.integrator, steps, s.tolerance in BOTH:
        explicit = s.integrator in EXPLICIT
        s.dt = TIME / steps
        for s.precision in (32, 64) if explicit else (32,):
            if side <= 25 or not explicit:
                on_both(b, out, sample, exact)


def backends(b):
    """Times are wall times on both backends; the reference runs on one thread."""
    if b.backend != lib.DRAPE_GPU:
        return
    b.wall = True
    with b.table("backends", "side,backend,integrator,precision,tolerance,dt,substeps,"
                 "iterations,seconds,rms m,end") as out:
        grid(b, out, 9 if b.quick else 25, 768 if b.quick else 3072)
        if not b.quick:
            grid(b, out, 129, 12288)
    b.backend, b.wall = lib.DRAPE_GPU, False
