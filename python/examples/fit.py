# SPDX-License-Identifier: Apache-2.0
"""Fits a fabric's `bend` to the drape coefficient of Cusick's test (BS 5058):
a disc of cloth of radius 15 cm hangs over a plate of 9 cm, and the coefficient is the
share of the overhanging ring that its shadow covers.

usage: fit.py [COEFFICIENT in %]
"""

from __future__ import annotations

import sys

import numpy as np

import drape

DISC, PLATE = 0.15, 0.09  # m
CELL = 0.0125  # m
COTTON = {"density": 0.12, "stretch": 1000, "shear": 10, "thickness": 1e-3}


def disc(bend: float) -> drape.World:
    """Returns a world with the disc, held where it lies on the plate."""
    half = round(DISC / CELL) + 1
    side = 2 * half + 1
    at = np.arange(-half, half + 1) * CELL
    size = 2 * half * CELL
    corners = []  # what is cut away of each row, left and right
    for j, z in enumerate(at):
        wide = np.sqrt(max(DISC**2 - z**2, 0)) + CELL / 4
        low, high = (j - 0.25) * CELL, (j + 0.25) * CELL
        keep = np.flatnonzero(np.abs(at) <= wide) if abs(z) <= DISC else []
        first, last = (keep[0], keep[-1]) if len(keep) else (side, side)
        if first > 0:
            right = (first - 0.5) * CELL
            corners.append(drape.Region(rect=[0, max(low, 0), right, high]))
        if last < side - 1:
            left = (last + 0.5) * CELL
            corners.append(drape.Region(rect=[left, max(low, 0), size, high]))
    x, z = np.meshgrid(at, at)
    radius, angle = np.hypot(x, z), np.arctan2(z, x)
    # waves of many numbers, so that no number of folds is given
    wave = sum(np.cos(k * angle + k * k) for k in range(2, 12))
    y = 2e-3 * np.maximum(radius - PLATE, 0) * wave
    cloth = drape.Cloth(
        name="disc",
        particles=[side, side],
        size=[size, size],
        material={**COTTON, "bend": bend},
        positions=np.stack([x, y, z], axis=2).reshape(-1, 3),
        holes=corners,
    )
    world = drape.World(drape.Scene(cloths=[cloth], tolerance=1e-4), precision=64)
    middle = world.select("disc", disc=[size / 2, size / 2, PLATE + 0.85 * CELL])
    world.pin("plate", "disc", middle)
    return world


def shadow(world: drape.World) -> float:
    """Returns the area of the disc's shadow from above, m²: its outline is what is
    farthest from the middle in each direction."""
    tri = world.positions[world.triangles][:, :, [0, 2]]
    sides = np.linspace(0, 1, 9)[:, None, None]
    points = [
        a + sides * (b - a) for a, b in ((tri[:, k], tri[:, k - 1]) for k in range(3))
    ]
    x, z = np.concatenate(points).reshape(-1, 2).T
    sector = ((np.arctan2(z, x) / (2 * np.pi) + 0.5) * 360).astype(int) % 360
    far = np.full(360, PLATE)
    np.maximum.at(far, sector, np.hypot(x, z))
    return float(np.pi * (far**2).mean())


def coefficient(bend: float) -> float:
    """Returns the drape coefficient of a `bend`, %."""
    world = disc(bend)
    whole, plate = shadow(world), np.pi * PLATE**2
    for _ in range(40):  # until it hangs still
        before = shadow(world)
        world.step(10)
        if world.steps >= 60 and abs(shadow(world) - before) < 1e-4 * whole:
            break
    return 100 * (shadow(world) - plate) / (whole - plate)


def main(wanted: float = 60) -> float:
    """Finds the `bend` of a coefficient by halving; returns it, N·m."""
    low, high = 1e-7, 1e-3
    for _ in range(9):
        bend = float(np.sqrt(low * high))
        found = coefficient(bend)
        print(f"bend {bend:.2e} N·m: {found:.1f} %")
        low, high = (bend, high) if found < wanted else (low, bend)
        if abs(found - wanted) < 1:
            break
    return bend


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]))
