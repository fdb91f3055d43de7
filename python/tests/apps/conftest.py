# SPDX-License-Identifier: Apache-2.0
"""Small runs, made by the tool, for the tests of export, view and Blender."""

from __future__ import annotations

from pathlib import Path

import pytest

from apps.runs import STILL, make, moving, sew


@pytest.fixture(scope="session")
def still(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 32 bits whose obstacles stand still."""
    return make(tmp_path_factory.mktemp("runs") / "still", STILL)


@pytest.fixture(scope="session")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run at 24 frames a second of which every second frame is there."""
    folder = tmp_path_factory.mktemp("runs") / "pushed"
    return make(folder, moving(), "--every", "2")


@pytest.fixture(scope="session")
def sewn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A T-shirt that `drape sew` has sewn."""
    return sew(tmp_path_factory.mktemp("sewn"), 60)


@pytest.fixture(scope="session")
def wide(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 64 bits."""
    folder = tmp_path_factory.mktemp("runs") / "wide"
    return make(folder, STILL, "--precision", "64", "--frames", "2")
