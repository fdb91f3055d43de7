# SPDX-License-Identifier: Apache-2.0
"""A gripper folds a towel: two jaws close on an edge that hangs over a table, carry it
over the towel's middle and let it go. Nothing is pinned: friction holds the towel.

usage: gripper.py [PICTURE.png]
"""

from __future__ import annotations

import sys

import numpy as np

import drape

TOP, FOLD = 0.70, 0.03  # m: height of the table, and x of the line of the fold
REACH = 0.17  # m, from that line to the middle of the jaws
HALF = 0.01  # m, of a jaw's height
OPEN, SHUT = 0.03, 0.0012  # m, from the middle of the grip to a jaw

towel = drape.Cloth(
    name="towel",
    particles=[41, 41],
    size=[0.32, 0.32],
    material={"name": "blanket", "friction": 0.6},
    start=drape.Start(at=[0.04, TOP + 0.004, 0]),
)
table = drape.Obstacle(
    name="table", shape="box", extent=[0.45, 0.04, 0.5], at=[-0.075, TOP - 0.02, 0]
)
jaw = {"shape": "box", "extent": [0.03, 2 * HALF, 0.12], "friction": 0.9}
jaws = [drape.Obstacle(name=name, **jaw) for name in ("upper", "lower")]
for each, up in zip(jaws, (1, -1), strict=True):
    each.at = [FOLD + REACH, TOP + up * (OPEN + HALF), 0]


def grip(world: drape.World, angle: float, gap: float, back: float = 0) -> None:
    """Tells both jaws where they are next: turned about the line of the fold by an
    angle, so far from the middle of the grip, and pulled back along it, m."""
    turn = [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]
    c, s = np.cos(angle), np.sin(angle)
    for name, up in (("upper", 1), ("lower", -1)):
        x, y = REACH + back, up * (gap + HALF)
        at = [FOLD + c * x - s * y, TOP + 0.002 + s * x + c * y, 0]
        start = [FOLD + REACH, TOP + up * (OPEN + HALF), 0]
        world.set_pose(name, at, turn, start)


def main(picture: str | None = None) -> float:
    """Folds the towel; returns how far its edge has come, m."""
    scene = drape.Scene(cloths=[towel], obstacles=[table, *jaws], dt=1 / 120)
    world = drape.World(scene)
    edge = world.select("towel", edge="u1")
    clean = world.step(30).clean
    before = world.read()[0][edge]
    held = []
    parts = [
        (40, lambda t: (0, OPEN + (SHUT - OPEN) * t, 0)),
        (140, lambda t: (2.85 * (3 - 2 * t) * t * t, SHUT, 0)),
        (20, lambda t: (2.85, SHUT + (OPEN / 2 - SHUT) * t, 0)),
        (60, lambda t: (2.85, OPEN / 2, 0.2 * t)),
        (60, lambda t: (2.85, OPEN / 2, 0.2)),
    ]
    for steps, path in parts:
        for k in range(1, steps + 1):
            grip(world, *path(k / steps))
            clean = world.step().clean and clean
            if steps == 140:  # what the jaws bear while they carry
                contacts = world.contacts()
                held.append(np.abs(contacts.body_forces[2:]).max())
    now = world.read()[0][edge]
    moved = float((before - now)[:, 0].mean())
    print(f"the edge has come {moved:.3f} m, held by {np.median(held):.2f} N a jaw")
    print("every step clean" if clean else "a step was not clean")
    if picture:
        world.render(picture)
    assert clean and world.audit().count == 0
    return moved


if __name__ == "__main__":
    main(*sys.argv[1:2])
