# SPDX-License-Identifier: Apache-2.0
"""Drift of energy in long runs, the effect of one unit in the last place at the start, and
scenes far from the origin. spec/accuracy.md §6"""
import math

import numpy as np
from drape._core import lib

from bench.accuracy.run import INTEGRATORS, Run, distance
from bench.accuracy.scenes import Sample, ball, scene, sheet
from validate.world import total


def long_runs(b):
    """An undamped drum, whose energy symplectic methods must keep; dissipative methods
    may lose but not gain it."""
    steps = 2000 if b.quick else 100000
    with b.table("drift", "integrator,precision,dt,step,energy by the first") as out:
        for method in (lib.DRAPE_EULER, lib.DRAPE_VERLET, lib.DRAPE_RK4, lib.DRAPE_BW,
                       lib.DRAPE_CK):
            for bits in (32, 64):
                long_run(b, out, method, bits, steps)


def long_run(b, out, method, bits, steps):
    sample, name = Sample(b, "stretched", 6), INTEGRATORS[method]
    s = sample.settings
    sample.cloth.material.damping = 0
    s.integrator, s.precision = method, bits
    s.dt = 5e-4  # a third of Verlet's limit
    first = most = 0

    def note(_, report):
        nonlocal first, most
        energy = report.kinetic + report.elastic + report.potential
        first = energy if report.step == 1 else first
        most = max(most, abs(energy / first - 1))
        if report.step == 1 or report.step % (steps // 100) == 0:
            out.row("%s,%d,%.4g,%d,%.6g", name, bits, s.dt, report.step, energy / first)
        return True

    run = Run(b, sample, steps, note)
    end = run.energy / first - 1
    b.check(run.steps == steps and not run.outcome,
            f"{name}, {bits} bits: {run.steps} of {steps} steps, {run.word}")
    b.check(most < 0.05 if method in (lib.DRAPE_EULER, lib.DRAPE_VERLET) else end < 1e-3,
            f"{name}, {bits} bits: energy off by {most:g}, at the end {end:g}")


def fall(b, side, offset):
    """A sheet above a ball, so far along x, and the sheet."""
    made = scene(b)
    cloth = sheet(made, side, 0.8, 0.53)
    cloth.material.thickness = 0.004
    cloth.x = np.stack([offset - 0.4 + 0.8 * cloth.i / (side - 1),
                        np.full(side * side, 0.53),
                        -0.4 + 0.8 * cloth.j / (side - 1)], 1)
    made.body(*ball(0.2, (offset, 0.3, 0), 32))
    return made, cloth


def one_unit(b, out, name):
    """Compares two runs, of which the second starts with one coordinate higher by one unit
    in the last place of binary32. The sheet falls on a ball, or hangs by two corners."""
    side, steps = (9, 10) if b.quick else (33, 180)
    n, found = side * side, []
    for unit in (False, True):
        made, cloth = fall(b, side, 0)
        if unit:
            height = np.float32(cloth.x[n // 2, 1])
            cloth.x[n // 2, 1] = np.nextafter(height, np.float32(1))
        if name != "ball":
            made.bodies.clear()
            cloth.pin(0, 0)
            cloth.pin(side - 1, 0)
        states = []

        def keep(world, report, states=states):
            world.read()
            y = world.x[:n, 1]
            states.append((world.x[:n].copy(), (report.kinetic + report.elastic,
                                                total(y / n), y.min())))
            return True

        Run(b, made, steps, keep)
        found.append(states)
    for t, ((x, sums), (x1, sums1)) in enumerate(zip(*found)):
        d = (x - x1).ravel()
        row = [math.sqrt(total(d * d) / n), np.abs(d).max()]
        for one, other in zip(sums, sums1):
            row += [one, abs(one - other)]
        out.row("%s,%d,%.3e,%.3e" + 3 * ",%.6g,%.3e", name, t + 1, *row)


def offsets(b):
    side, origin = 17, None
    n = side * side
    with b.table("offset", "offset m,precision,rms m to the origin's,contacts,impacts,end,"
                 "text") as out:
        for bits in (64, 32):
            for offset in (0, *(10.0**k for k in range(6))):
                made, _ = fall(b, side, offset)
                made.settings.precision = bits
                run = Run(b, made, 30)
                if run.x is not None:
                    run.x[:n, 0] -= offset
                origin = origin or run
                out.row('%g,%d,%.3g,%d,%d,%s,"%s"', offset, bits, distance(run, origin, n),
                        run.contacts, run.impacts, run.word, run.text)


def drift(b):
    long_runs(b)
    with b.table("ulp", "scene,step,rms m,max m,own energy J,own differs J,mean height m,"
                 "mean differs m,lowest m,lowest differs m") as out:
        one_unit(b, out, "ball")
        one_unit(b, out, "two corners")
    if not b.quick:
        offsets(b)
