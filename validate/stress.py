# SPDX-License-Identifier: Apache-2.0
"""Energy that steps gain in scenes drawn at random: sheets that fall on a drum, of any
cells, stiffness, facets and steps. spec/limits.md, Energy in contact

usage: PYTHONPATH=build/python/package python -m validate.stress FIRST LAST
(`make build/validate` makes that package.) Prints a line for each scene, of seeds from
FIRST to LAST - 1, in which a step gains more than 3 % of the energy of the fall, or that
is not clean; and how many these are.
"""
import argparse
import random
from types import SimpleNamespace

import numpy as np
from drape._core import lib

from validate.belt import drum
from validate.scheme import SCHEMES
from validate.world import G, Scene

GAIN, STEPS = 0.03, 60


def draw(seed):
    """The numbers of a scene."""
    r = random.Random(seed)
    return SimpleNamespace(
        how=r.choice(SCHEMES), bits=r.choice((32, 64)), rate=r.choice((30, 60, 120, 240)),
        cell=10**r.uniform(-2.3, -1.2), m=r.randint(3, 12), n=r.randint(3, 8),
        sheets=r.randint(1, 3), stretch=10**r.uniform(0, 4), bend=10**r.uniform(-7, -3),
        thickness=10**r.uniform(-3.5, -2.3), friction=r.choice((0, 0.3, 1)),
        radius=10**r.uniform(-2, -0.7), facets=r.choice((6, 16, 64, 256, 1024)),
        speed=10**r.uniform(-1, 1), aside=r.choice((0, 1)))


def make(d):
    """The scene, in which sheets lie over each other above the drum and come down."""
    scene = Scene(SimpleNamespace(backend=lib.DRAPE_REF, bits=d.bits), d.how, 1 / d.rate)
    scene.material.stretch, scene.material.shear = d.stretch, 0.3 * d.stretch
    scene.material.bend, scene.material.friction = d.bend, d.friction
    scene.material.thickness = d.thickness
    for k in range(d.sheets):
        high = d.radius + 0.002 + 1.3 * (k + 1) * d.thickness
        s = scene.sheet(d.m, d.n, d.cell, (d.cell * (0.2 * k - (d.m - 1) / 2), high,
                                           d.cell * (0.1 - (d.n - 1) / 2)))
        s.v[:] = d.aside * d.speed, -d.speed, 0
    drum(scene, d.radius, max(0.2, d.n * d.cell), d.facets, d.friction)
    return scene


def run(d):
    """The largest gain of a step, over the energy of the fall, and all outcomes. None:
    the start is refused."""
    scene = make(d)
    world, _ = scene.create()
    if world is None:
        return None
    mass = sum(s.mass for s in scene.cloths)
    due = mass * ((1 + d.aside) * d.speed**2 / 2 + G * d.radius)
    before = sum(s.mass * G * s.x[0, 1] for s in scene.cloths)
    before += mass * (1 + d.aside) * d.speed**2 / 2
    gain = outcome = 0
    for _ in range(min(STEPS, int(0.3 * d.rate))):
        if not world.goes():
            return np.inf, outcome | world.report.outcome
        r = world.report
        now = r.kinetic + r.elastic + r.potential
        gain, before = max(gain, (now - before) / due), now
        outcome |= r.outcome
    return gain, outcome


def main():
    parser = argparse.ArgumentParser(prog="validate.stress", description="Energy that "
                                     "steps gain in scenes drawn at random.")
    parser.add_argument("first", type=int, help="the first seed")
    parser.add_argument("last", type=int, help="the seed behind the last")
    options = parser.parse_args()
    scenes = found = 0
    for seed in range(options.first, options.last):
        d = draw(seed)
        result = run(d)
        if result is None:
            continue
        scenes += 1
        if result[0] > GAIN or result[1]:
            found += 1
            numbers = ", ".join(f"{name} {value:.3g}" for name, value in vars(d).items()
                                if name != "how")
            print(f"{seed}: gains {result[0]:.3g}, outcome {result[1]}; {d.how.name}, "
                  f"{numbers}", flush=True)
    print(f"{found} of {scenes} scenes")


if __name__ == "__main__":
    main()
