# SPDX-License-Identifier: Apache-2.0
"""What a feature costs where it is used, and that it costs nothing where it is not; the
bare scene in a library that has no other stage; a scene that is asleep.
spec/accuracy.md §7"""
import ctypes
import math
import subprocess
import sys
import time

import numpy as np
from drape._core import ffi, lib
from drape._library import Calls

from bench.accuracy.run import IMPLICIT, INTEGRATORS, Run
from bench.accuracy.scenes import WIND, ball, plane, scene, sheet
from validate.world import doubles

SIDE = 65


class Meter:
    """Counts the bytes that the library holds, and the most that it held."""

    def __init__(self):
        libc = ctypes.CDLL(None)
        libc.aligned_alloc.argtypes = 2 * [ctypes.c_size_t]
        libc.aligned_alloc.restype = ctypes.c_void_p
        libc.free.argtypes = [ctypes.c_void_p]
        self.held = self.most = 0

        @ffi.callback("void *(*)(void *, size_t)")
        def allocate(_, size):
            self.held += size
            self.most = max(self.most, self.held)
            return ffi.cast("void *", libc.aligned_alloc(64, (size + 64) // 64 * 64))

        @ffi.callback("void (*)(void *, void *, size_t)")
        def release(_, memory, size):
            self.held -= size if memory else 0
            libc.free(int(ffi.cast("uintptr_t", memory)))

        self.allocator = allocate, release, ffi.NULL


class Bare:
    """The bare scene: one cloth, an explicit integrator, no collisions; and, if that is
    asked for, one feature more."""

    def __init__(self, b, feature=None):
        self.scene = scene(b)
        self.settings, self.calls = self.scene.settings, Calls(None, None)
        self.meter = Meter()
        self.settings.allocator = self.meter.allocator
        self.cloth = sheet(self.scene, SIDE, 1, 0)
        self.cloth.material.damping = self.cloth.material.friction = 0
        s = self.settings
        s.dt, s.integrator, s.self_collision, s.sleep = 1e-4, lib.DRAPE_VERLET, 0, 0
        if feature:
            feature(self)

    def body(self, detail, height, motion=-1):
        self.scene.body(*ball(0.1, (0, height, 0), detail), motion=motion)

    def implicit(self):
        self.settings.integrator = lib.DRAPE_BW

    def obstacle(self):
        self.body(24, -5)

    def large_obstacle(self):
        self.body(192, -5)

    def moving_obstacle(self):
        self.body(192, -5, self.scene.keys([0, 10], [(0, 0, 0), (1, 0, 0)]))

    def contact(self):
        self.body(24, -0.1015)

    def self_collision(self):
        self.settings.self_collision = 1

    def friction(self):
        self.cloth.material.friction = 0.5

    def wind(self):
        self.settings.wind = WIND

    def pins(self):
        for i in range(SIDE):
            self.cloth.pin(i, 0)

    def holes(self):
        self.cloth.hole[7::50] = 1

    def trace(self, function=None):
        self.calls.trace = function
        self.settings.trace, self.settings.trace_user = lib.core_trace, self.calls.pointer


FEATURES = {"nothing": None, "implicit solver": Bare.implicit,
            "static obstacle, 528 triangles": Bare.obstacle,
            "static obstacle, 36,480 triangles": Bare.large_obstacle,
            "moving obstacle, 36,480 triangles": Bare.moving_obstacle,
            "obstacle in contact": Bare.contact,
            "self-collision, flat": Bare.self_collision, "friction": Bare.friction,
            "wind": Bare.wind, "pins": Bare.pins, "holes": Bare.holes,
            "trace": Bare.trace, "report left out": None}


def time_all(b):
    """The seconds of a step with every feature, the least of several runs, and bytes. The
    features take turns, so that slow phases of the machine affect all of them."""
    steps, least, size = 2 if b.quick else 40, {}, {}
    for _ in range(1 if b.quick else 9):
        for name, feature in FEATURES.items():
            made = Bare(b, feature)
            run = Run(b, made.scene, steps, mute=name == "report left out")
            least[name] = min(least.get(name, math.inf), run.seconds / steps)
            size[name] = made.meter.most
    return least, size


def count_calls(b, feature):
    """How often each stage is called in four steps, and the candidates of these."""
    calls = {}

    def count(_, stage, *rest):
        calls[stage] = calls.get(stage, 0) + 1

    made = Bare(b, feature)
    made.trace(count)
    return calls, Run(b, made.scene, 4).candidates


def table(b):
    least, size = time_all(b)
    counts = {name: count_calls(b, feature) for name, feature in FEATURES.items()}
    with b.table("skip", "feature,ms a step,by the bare scene,MB,candidates,"
                 "stages more (calls a step)") as out:
        for name, (calls, candidates) in counts.items():
            more = " ".join(f"{stage} {(n + 3) // 4}" for stage, n in calls.items()
                            if stage not in counts["nothing"][0])
            out.row('"%s",%.4g,%.3f,%.4g,%d,"%s"', name, 1e3 * least[name],
                    least[name] / least["nothing"], 1e-6 * size[name], candidates, more)
            b.check(name == "obstacle in contact" or not candidates,
                    f"{name}: {candidates} candidates of the narrow phase")


def bare(b, library):
    """Runs the bare scene by a library; prints seconds a step, bytes and a hash of the
    positions, for `never`."""
    least, steps = math.inf, 40
    for _ in range(1 if b.quick else 9):
        one = Bare(b)
        kept = one.scene.fill()
        made, error = ffi.new("drape_world **"), ffi.new("drape_error *")
        assert library.drape_create(one.settings, made, error) == 0, error.text
        start = time.process_time()
        for _ in range(steps):
            assert library.drape_step(made[0], ffi.new("drape_step_report *")) == 0
        least = min(least, (time.process_time() - start) / steps)
        x = np.zeros((SIDE * SIDE, 3))
        library.drape_read(made[0], doubles(x), ffi.NULL)
        library.drape_destroy(made[0])
        del kept
    hashed = 14695981039346656037  # FNV-1a
    for byte in x.tobytes():
        hashed = (hashed ^ byte) * 1099511628211 % 2**64
    print(f"{least:.9g} {one.meter.most} {hashed:x}")


def ask(b, inside):
    """What `bare` prints in a process of its own, since the place of its memory can make
    all runs of a process 1.7 times as slow; None: it did not run."""
    command = [sys.executable, "-m", "bench.accuracy", "--inside", b.inside.path, "--bare",
               "inside" if inside else "package", *["--quick"][:b.quick], b.folder]
    found = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    return found.stdout.split() if found.returncode == 0 else None


def never(b):
    if b.backend == lib.DRAPE_GPU:
        return  # the other library lacks stages of the reference only
    asked = {"all stages": [], "only the bare scene's": []}
    for _ in range(1 if b.quick else 5):
        for inside, found in enumerate(asked.values()):
            found.append(ask(b, inside))
        b.check(all(found[-1] for found in asked.values()),
                "a program of the bare scene did not run")
    same = set()
    with b.table("never", "program,ms a step,bytes,hash of the positions") as out:
        for name, found in asked.items():
            least, size, hashed = min(filter(None, found), default=("nan", "0", "0"),
                                      key=lambda one: float(one[0]))
            out.row("%s,%.4g,%s,%s", name, 1e3 * float(least), size, hashed)
            same.add((size, hashed))
    b.check(len(same) == 1, "other bits or bytes without the stages")


class Watch:
    """Checks after each step that no bit changes while the scene is asleep, and that
    drape_wake, called after five steps asleep, changes no bit and wakes the scene. fell:
    the first step asleep, 0: none yet; seconds: of the last step awake, and asleep."""

    def __init__(self):
        self.fell, self.seconds, self.same, self.woke = 0, [0.0, 0.0], True, False
        self.last = None

    def __call__(self, world, report):
        world.read()
        asleep = bool(report.outcome & lib.DRAPE_ASLEEP)
        state = world.x.tobytes(), world.u.tobytes()
        if asleep:
            self.fell = self.fell or report.step
            self.same &= state == self.last
        self.seconds[asleep] = sum(report.seconds)
        if self.fell and report.step == self.fell + 5:
            lib.drape_wake(world.made)
            world.read()
            self.same &= self.last is None or world.x.tobytes() == self.last[0]
            state = world.x.tobytes(), world.u.tobytes()
        self.woke |= bool(self.fell) and report.step > self.fell + 5 and not asleep
        self.last = state
        return not self.woke


def sleep(b):
    """A sheet on a plane that runs until it has slept and been woken, or 300 steps."""
    with b.table("sleep", "integrator,tolerance,asleep from step,seconds awake,"
                 "seconds asleep,no bit changed,woke by command") as out:
        for integrator in IMPLICIT:
            for tolerance in (1e-6,) if b.quick else (1e-3, 1e-6):
                made, watch, name = scene(b), Watch(), INTEGRATORS[integrator]
                sheet(made, 17, 0.4, 0.0019)
                made.body(*plane(1))
                made.settings.integrator, made.settings.tolerance = integrator, tolerance
                Run(b, made, 300, watch)
                same = ("yes" if watch.same else "no") if watch.fell else ""
                out.row("%s,%g,%d,%.3g,%.3g,%s,%s", name, tolerance, watch.fell,
                        *watch.seconds, same, "yes" if watch.woke else "no")
                # Whether it sleeps at all can depend on a last bit: no check.
                b.check(not watch.fell or watch.woke, f"sleep, {name}: did not wake")
                b.check(watch.same, f"sleep, {name}: bits changed")


def skip(b):
    table(b)
    never(b)
    sleep(b)
