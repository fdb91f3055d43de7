# SPDX-License-Identifier: Apache-2.0
"""Orders of convergence, by the errors at a step and at half of it. spec/accuracy.md §2"""
import math

from drape._core import lib

from bench.accuracy.run import INTEGRATORS, Run, converged, distance
from bench.accuracy.scenes import Sample
from validate.world import NAN

EULER, MIDPOINT, VERLET, RK4, BW, CK = range(lib.DRAPE_EULER, lib.DRAPE_CK + 1)
# Scene and damping; then integrator, theory's order (0: none) and steps of the coarser of
# two runs. The orders are from spec/cloth/implicit.md §5 for Choi–Ko and from advance.md
# for the others. Where springs cross kinks of the force law, or where the wind is that of
# the step's start, theory gives no order.
FREE = ((EULER, 0, 2048), (VERLET, 0, 1024), (RK4, 0, 1024), (BW, 0, 2048), (CK, 0, 2048))
FITS = {("stretched", 0): ((EULER, 1, 2048), (VERLET, 2, 1024), (RK4, 4, 512),
                           (BW, 1, 4096), (CK, 2, 1024)),
        ("stretched", 1e-4): ((EULER, 1, 2048), (MIDPOINT, 2, 1024), (VERLET, 2, 1024),
                              (RK4, 4, 512), (BW, 1, 4096), (CK, 0, 2048)),
        ("hanging", 1e-4): FREE, ("flag", 1e-4): FREE}


def error(b, sample, duration, steps, exact):
    sample.settings.dt = duration / steps
    run = Run(b, sample, steps)
    if run.outcome & ~lib.DRAPE_UNCONVERGED or run.substeps != 1:
        return NAN
    return distance(run, exact, sample.cloth.count)


def fit(b, out, kind, damping, rows):
    """Rows of one scene, which share a converged run."""
    duration = 0.02 if b.quick else 0.04
    sample = Sample(b, kind, 6 if b.quick else 9)
    sample.cloth.material.damping = damping
    exact, _ = converged(b, sample, duration, 2048 if b.quick else 8192)
    sample.settings.tolerance = 1e-12
    for sample.settings.integrator, theory, steps in rows:
        if b.quick:
            if not theory:
                continue
            steps //= 8  # of a coarser grid and half the time
        coarse, fine = (error(b, sample, duration, n, exact) for n in (steps, 2 * steps))
        name, order = INTEGRATORS[sample.settings.integrator], math.log2(coarse / fine)
        out.row("%s,%g,%s,%d,%.3e,%.3e,%.3f,%g", kind, damping, name, steps, coarse, fine,
                order, theory)
        b.check(not theory or abs(order - theory) <= 0.1,
                f"order of {name}, {kind}, damping {damping:g}: {order:.3f}, theory "
                f"{theory}")


def orders(b):
    with b.table("orders", "scene,damping,integrator,steps,rms m,rms m at twice the steps,"
                 "order,theory") as out:
        for (kind, damping), rows in FITS.items():
            if not b.quick or rows is not FREE:
                fit(b, out, kind, damping, rows)
