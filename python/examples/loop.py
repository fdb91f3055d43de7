# SPDX-License-Identifier: Apache-2.0
"""A closed loop at 240 Hz: a ball presses on a held sheet, and a controller that reads
the contact force moves the ball so that it presses with a force that is asked for.

usage: loop.py
"""

from __future__ import annotations

import sys
import time

import numpy as np

import drape

RATE, WANTED = 240, 0.5  # steps a second; N
STIFF = 60.0  # N/m, about what the sheet resists the ball with
GAIN = 0.1  # of the error, in each step

sheet = drape.Cloth(
    name="sheet",
    particles=[31, 31],
    size=[0.6, 0.6],
    material="denim",
    pins=[drape.Pin(edge=edge) for edge in ("u0", "u1")],
)
ball = drape.Obstacle(name="ball", shape="sphere", radius=0.08, at=[0, 0.082, 0])


def main() -> float:
    """Runs two seconds; returns the mean error of the force in the last one, N."""
    scene = drape.Scene(cloths=[sheet], obstacles=[ball], dt=1 / RATE)
    world = drape.World(scene)
    height, forces = 0.0, []
    began = time.perf_counter()
    for _ in range(2 * RATE):
        force = world.contacts().body_forces[1, 1] if world.steps else 0.0
        height -= GAIN * (WANTED - force) / STIFF
        world.set_pose("ball", [0, height, 0])
        assert world.step().clean
        forces.append(force)
    took = time.perf_counter() - began
    last = np.array(forces[RATE:])
    print(f"asked for {WANTED} N; pressed with {last.mean():.3f} ± {last.std():.3f} N")
    print(f"the ball is {-world.pose('ball').position[1]:.3f} m lower")
    print(f"{2 * RATE / took:.0f} steps a second here", file=sys.stderr)
    return float(abs(last.mean() - WANTED))


if __name__ == "__main__":
    main()
