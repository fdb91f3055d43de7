# SPDX-License-Identifier: Apache-2.0
"""The strain that the page shows is that of known deformations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drape.export import Body, Run
from drape.viewer import strain


@pytest.fixture
def sheet(still: Path) -> Body:
    """A cloth with a hole."""
    return Run(still).bodies[0]


def rest(body: Body) -> np.ndarray:
    """The cloth at rest in the plane z = 0."""
    assert body.uv is not None and body.size is not None
    flat = body.uv.astype(np.float64) * body.size
    return np.concatenate([flat, np.zeros((len(flat), 1))], 1)


def test_a_rigid_motion_does_not_strain(sheet: Body) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    x = rest(sheet) @ turn.T + [5, -3, 2]
    assert np.allclose(strain.principal(sheet, x), 0, atol=1e-6)


def test_stretch_and_squeeze(sheet: Body) -> None:
    x = rest(sheet) * [1.1, 0.95, 1]
    least, largest = strain.principal(sheet, x)
    assert np.allclose(least, -0.05, atol=1e-6)
    assert np.allclose(largest, 0.1, atol=1e-6)
    assert np.allclose(strain.at_vertices(sheet, x), 0.1, atol=1e-6)
    assert np.allclose(strain.at_vertices(sheet, x * [0.8, 1, 1]), -0.12, atol=1e-6)


def test_shear(sheet: Body) -> None:
    x = rest(sheet)
    x[:, 0] += 0.2 * x[:, 1]
    least, largest = strain.principal(sheet, x)
    stretch = np.linalg.svd(np.array([[1, 0.2], [0, 1]]))[1]
    assert np.allclose(largest, stretch[0] - 1, atol=1e-6)
    assert np.allclose(least, stretch[1] - 1, atol=1e-6)


def test_colours_of_the_scale() -> None:
    got = strain.colours(np.array([-9, -0.1, 0, 0.1, 9]), 0.1)
    assert np.array_equal(got, strain.SCALE.astype(np.float32)[[0, 0, 1, 2, 2]])


def test_an_obstacle_has_none(still: Path) -> None:
    ball = Run(still).bodies[2]
    with pytest.raises(ValueError, match="ball"):
        strain.principal(ball, np.zeros((len(ball.rows), 3)))
