# SPDX-License-Identifier: Apache-2.0
"""Scenes that the tests share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "app/scenes"


@pytest.fixture
def tiny() -> Path:
    """A small cloth that falls on a sphere: contact from the third step on."""
    return SCENES / "tiny.json"


@pytest.fixture
def sheet() -> dict[str, Any]:
    """A cloth alone, by its keys."""
    return {
        "name": "sheet",
        "cloths": [{"particles": [7, 5], "size": [0.6, 0.4]}],
    }
