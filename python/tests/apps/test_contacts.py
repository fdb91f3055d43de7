# SPDX-License-Identifier: Apache-2.0
"""The contacts of a recorded run: by the package, by another reader, by the page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

import drape
from apps.runs import FRAMES, STILL, make
from drape.export.run import Run, RunError
from drape.viewer.live import contacts_of
from drape.viewer.source import Recorded


@pytest.fixture(scope="module")
def touching(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with contacts."""
    folder = tmp_path_factory.mktemp("runs") / "touching"
    return make(folder, STILL, "--contacts", "--precision", "64")


def test_they_are_those_of_the_world(touching: Path, tmp_path: Path) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(STILL))
    world = drape.World(file, precision=64)
    with world.record(tmp_path / "run", contacts=True):
        world.step(FRAMES)
    pairs = world.contacts()
    for folder in (touching, tmp_path / "run"):
        run = Run(folder)
        start, found = run.contacts(0), run.contacts(FRAMES)
        assert start is not None and len(start) == 0
        assert found is not None and len(found) == len(pairs) > 0
        for name in ("kind", "vertices", "bodies", "weights", "normals", "gaps"):
            assert np.array_equal(getattr(found, name), getattr(pairs, name)), name
        assert np.array_equal(found.impulses, pairs.impulses)
        assert found.dt == pairs.dt
        told = run.report["steps"][-1]["impulses"]
        assert told["slice"] == pairs.dt
        assert np.array_equal(told["bodies"], pairs.body_impulses)
        live, shown = contacts_of(world), Recorded(folder).contacts(FRAMES)
        assert live is not None and shown is not None
        assert np.array_equal(live.points, shown.points)
        assert np.array_equal(live.forces, shown.forces)


def test_another_reader_reads_them(touching: Path) -> None:
    trimesh = need("trimesh")
    found = Run(touching).contacts(FRAMES)
    assert found is not None
    path = touching / f"frames/contacts_{FRAMES:04d}.ply"
    cloud = trimesh.load(path)
    assert np.array_equal(cloud.vertices, found.points)
    rows = cloud.metadata["_ply_raw"]["vertex"]["data"]
    assert np.array_equal(rows["impulse_y"].ravel(), found.impulses[:, 1])
    assert np.array_equal(rows["body_b"].ravel(), found.bodies[:, 1])


def test_a_run_without_and_a_damaged_file(still: Path, tmp_path: Path) -> None:
    assert Run(still).contacts(FRAMES) is None
    assert Recorded(still).contacts(FRAMES) is None
    folder = make(tmp_path / "run", STILL, "--contacts", "--frames", "1")
    path = folder / "frames/contacts_0001.ply"
    path.write_bytes(path.read_bytes() + b"x")
    with pytest.raises(RunError, match=r"contacts_0001\.ply: its length"):
        Run(folder).contacts(1)
    path.write_bytes(b"ply\n")
    with pytest.raises(RunError, match=r"contacts_0001\.ply: expected contacts"):
        Run(folder).contacts(1)


def test_an_explicit_integrator_is_refused(tmp_path: Path) -> None:
    scene: dict[str, Any] = {**STILL, "integrator": "verlet", "dt": 1e-4}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    world = drape.World(file)
    with pytest.raises(drape.SceneError, match="explicit integrator"):
        world.record(tmp_path / "run", contacts=True)
    assert not (tmp_path / "run").exists()
