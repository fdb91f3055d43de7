# SPDX-License-Identifier: Apache-2.0
"""Runs of scenes, and what the parts of build/accuracy share: tables, checks, a clock."""
import math
import sys
import time

import numpy as np
from drape._core import ffi, lib

from validate.world import NAN, doubles, total

INTEGRATORS = ("euler", "midpoint", "verlet", "rk4", "baraff-witkin", "choi-ko", "bdf2")
PRECONDS = ("jacobi", "multigrid")
BACKENDS = ("ref", "gpu")
EXPLICIT = range(lib.DRAPE_EULER, lib.DRAPE_RK4 + 1)
IMPLICIT = range(lib.DRAPE_BW, lib.DRAPE_CK + 1)
# How a run ended is the first of these that one of its steps reported.
WORDS = ((lib.DRAPE_DIVERGED, "diverged"), (lib.DRAPE_TRAPPED, "trapped"),
         (lib.DRAPE_ROLLBACK, "rolled back"), (lib.DRAPE_ZONES, "zones"),
         (lib.DRAPE_UNCONVERGED, "unconverged"))


class Bench:
    """One call of the program. quick: a small form, for `make check`; wall: wall time
    for the reference, too; bits: of a number in the states of scenes to be made; inside:
    the library in which steps are run that this one refuses."""

    def __init__(self, folder, quick, backend, inside):
        self.folder, self.quick, self.inside = folder, quick, inside
        self.backend = BACKENDS.index(backend)
        self.bits, self.wall = 32, False
        self.passed = self.failed = 0

    def table(self, name, header):
        """A table of this name, which gets its rows by `row`."""
        return Table(f"{self.folder}/{name}.csv", header)

    def check(self, good, text):
        """Counts a check, and prints it if it failed."""
        self.passed += bool(good)
        self.failed += not good
        if not good:
            print("FAILED", text, flush=True)

    def clock(self):
        """Processor time of the reference, s, and wall time of a device."""
        wall = self.wall or self.backend == lib.DRAPE_GPU
        return time.monotonic() if wall else time.process_time()


class Table:
    """A csv file."""

    def __init__(self, path, header):
        try:
            self.file = open(path, "w", encoding="utf-8")
        except OSError:
            sys.exit(f"accuracy: {path}: cannot be written")
        self.row(header)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def row(self, form, *values):
        print(form % values if values else form, file=self.file, flush=True)


class Run:
    """A run of `steps` steps, or until a step fails or diverges, or until watch(world,
    report) returns False. A last state that is not finite is a failed check.

    steps, outcome, iterations, slices, solves, candidates, impacts: of all steps together;
    substeps, residual, contacts: the largest; seconds: in drape_step; energy, own: J at the end, with
    gravity's and without; x, v: the last state, None if the scene was refused, for the
    reason `text`. mute: steps are asked for no report."""

    def __init__(self, b, scene, steps, watch=None, mute=False):
        self.steps = self.outcome = self.iterations = self.substeps = 0
        self.slices = self.solves = self.contacts = self.candidates = self.impacts = 0
        self.residual = self.seconds = self.energy = self.own = 0.0
        self.finite, self.x, self.v = True, None, None
        scene.settings.backend = b.backend
        world, self.text = scene.create()
        self.good = world is not None
        if self.good:
            self._go(b, world, steps, watch, mute)
            self._keep(b, world)

    def _go(self, b, world, steps, watch, mute):
        report = world.report
        asked = ffi.NULL if mute else report
        for _ in range(steps):
            start = b.clock()
            status = lib.drape_step(world.made, asked)
            self.seconds += b.clock() - start
            self.good = status == lib.DRAPE_OK
            if not self.good:
                break
            self.outcome |= report.outcome
            if report.outcome & lib.DRAPE_DIVERGED:
                break
            self._add(report)
            if watch and not watch(world, report):
                break

    def _add(self, report):
        self.steps += 1
        self.own = report.kinetic + report.elastic
        self.energy = self.own + report.potential
        self.iterations += report.iterations
        self.slices += report.slices
        self.solves += report.work.solves
        self.candidates += report.candidates
        self.impacts += report.impacts
        self.substeps = max(self.substeps, report.substeps)
        self.residual = max(self.residual, report.residual)
        self.contacts = max(self.contacts, report.contacts)

    def _keep(self, b, world):
        world.read()
        self.x, self.v = world.x, world.u
        self.finite = bool(math.isfinite(self.energy) and np.isfinite(self.x).all() and
                           np.isfinite(self.v).all())
        b.check(self.finite, f"a state is not finite, and a step said {self.outcome}")

    @property
    def word(self):
        """A word for how it ended: stable, refused, diverged, …"""
        if not self.finite:
            return "not finite"
        if not self.good:
            return "refused"
        return next((word for bit, word in WORDS if self.outcome & bit), "stable")


def distance(a, b, n):
    """The root of the mean squared distance of the first n positions of two runs, m."""
    if a.x is None or b.x is None:
        return NAN
    d = (a.x[:n] - b.x[:n]).ravel()
    return math.sqrt(total(d * d) / n)


def converged(b, sample, duration, steps):
    """The run by RK4 in binary64 of spec/accuracy.md §1, and its distance, m, from the
    run with half as many steps."""
    settings = sample.settings
    settings.precision, settings.integrator = 64, lib.DRAPE_RK4
    settings.dt = 2 * duration / steps
    coarse = Run(b, sample, steps // 2)
    settings.dt = duration / steps
    fine = Run(b, sample, steps)
    b.check(fine.good and not fine.outcome, f"the converged run: {fine.word}")
    return fine, distance(coarse, fine, sample.cloth.count)


def pairs(world, cloths):
    """The intersecting pairs of triangles in the state, by drape_audit; -1: it failed."""
    made = world.made
    nt = lib.drape_triangles(made)
    tri = np.zeros((nt, 3), np.int32)
    group = np.zeros(nt, np.int32)
    world.read()
    lib.drape_read_triangles(made, ffi.cast("int32_t (*)[3]", tri.ctypes.data))
    group[:lib.drape_first_triangle(made, cloths)] = 1
    mesh = ffi.new("drape_mesh *", {
        "nv": len(world.x), "nt": nt, "x": doubles(world.x), "threads": 1,
        "tri": ffi.cast("int32_t (*)[3]", tri.ctypes.data),
        "group": ffi.cast("int32_t *", group.ctypes.data)})
    found = ffi.new("int64_t *", -1)
    status = lib.drape_audit(mesh, 0, ffi.NULL, found, ffi.NULL)
    return found[0] if status == lib.DRAPE_OK else -1
