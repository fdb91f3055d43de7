# SPDX-License-Identifier: Apache-2.0
"""Books of energy and momentum, kept from a world's arrays alone, beside what its
reports and contacts say."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import drape

M, N, SIDE = 7, 5, 0.5
DENSITY = (0.2, 0.3)


def scene(**keys: Any) -> dict[str, Any]:
    """Two cloths, of which the second falls on a ball."""
    cloths = [
        {
            "particles": [M, N],
            "size": [SIDE, SIDE],
            "material": {"density": density},
            "start": {"at": [2 * (1 - k), 0.36, 0]},
        }
        for k, density in enumerate(DENSITY)
    ]
    ball = {"shape": "sphere", "radius": 0.15, "at": [0.1, 0.2, 0], "detail": 12}
    return {"cloths": cloths, "obstacles": [ball], **keys}


def strain(world: drape.World) -> None:
    """Pins all particles of the first cloth, where they strain it. So it is at rest
    after a step, and has energy when it falls asleep."""
    x = world.read()[0][: M * N]
    x[:, 0] = x[0, 0] + 1.05 * (x[:, 0] - x[0, 0])
    world.set_pins(0, np.arange(M * N), x)


def masses(*densities: float) -> NDArray[np.float64]:
    """Masses of particles: each has a quarter of the cells around it."""
    share = np.zeros((N, M))
    for j in (slice(1, None), slice(None, -1)):
        for i in (slice(1, None), slice(None, -1)):
            share[j, i] += 0.25 * SIDE / (N - 1) * SIDE / (M - 1)
    return np.concatenate([density * share.ravel() for density in densities])


def check(world: drape.World, m: NDArray[np.float64], g: NDArray[np.float64]) -> None:
    """spec/cloth/energy.md §2: both energies err by 40 u of the sum of their terms'
    sizes at most, and masses by some u of their own: 48 u in all."""
    report = world.report
    assert report
    x, v = (each[: len(m)] for each in world.read())
    u = 2.0 ** -(24 if world.precision == 32 else 53)
    kinetic = 0.5 * m * (v * v).sum(axis=1)
    potential = -m[:, None] * x * g
    assert abs(report.kinetic - kinetic.sum()) <= 48 * u * kinetic.sum()
    assert abs(report.potential - potential.sum()) <= 48 * u * abs(potential).sum()


@pytest.mark.parametrize("precision", [32, 64])
@pytest.mark.parametrize("integrator", ["baraff-witkin", "choi-ko", "bdf2"])
def test_energies(precision: int, integrator: str) -> None:
    world = drape.World(scene(precision=precision, integrator=integrator))
    strain(world)
    m, g = masses(*DENSITY), np.array([0, -9.81, 0])
    asleep = []
    for step in range(45):
        if step == 4:
            g = np.array([0.5, -8, 0.25])
            world.set_gravity(g)
        if step == 6:
            world.set_material(0, {"density": 0.5})
            m = masses(0.5, DENSITY[1])
        row = world.step()[0]
        asleep.append(row.asleep)
        check(world, m, g)
        assert row.elastic > 1e-3 or not row.asleep
        if step == 40:  # another world of the same scene, from the checkpoint
            data = world.checkpoint()
            world = drape.World(scene(precision=precision, integrator=integrator))
            world.restore(data)
    assert asleep[0] == 0 and asleep[-1] == 1
    world.set_material(0, {"density": 0.25})
    assert world.step()[0].asleep == 0
    for _ in range(40):  # it sleeps again, with other energies
        asleep.append(world.step()[0].asleep)
        check(world, masses(0.25, DENSITY[1]), g)
    assert asleep[-1] == 1


@pytest.mark.parametrize("response", ["solve", "impulses"])
def test_a_world_asleep_keeps_its_books(response: str) -> None:
    """The energies of a step that is skipped are those of the last that was not."""
    world = drape.World(scene(response=response))
    strain(world)
    world.remove(1)
    world.step(2)
    rows = world.step(40)
    assert rows[-1].outcome == drape.Outcome.ASLEEP
    assert len({(r.kinetic, r.elastic, r.potential) for r in rows}) == 1
    assert rows[-1].elastic > 0
    check(world, masses(DENSITY[0]), np.array([0, -9.81, 0]))
