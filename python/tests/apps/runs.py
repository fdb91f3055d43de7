# SPDX-License-Identifier: Apache-2.0
"""Small scenes, and their runs by the tool."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
FRAMES = 8

# Two cloths, of which one has a hole and both have one name; a still ball.
STILL: dict[str, Any] = {
    "name": "two sheets",
    "frames": FRAMES,
    "cloths": [
        {
            "name": "sheet é",
            "particles": [13, 9],
            "size": [0.6, 0.4],
            "start": {"at": [0, 0.36, 0]},
            "material": {"thickness": 0.005},
            "holes": [{"disc": [0.45, 0.2, 0.08]}],
        },
        {
            "name": "sheet é",
            "particles": [9, 9],
            "size": [0.4, 0.4],
            "start": {"at": [0.1, 0.42, 0]},
            "material": {"thickness": 0.005},
        },
    ],
    "obstacles": [
        {
            "name": "ball",
            "shape": "sphere",
            "radius": 0.15,
            "at": [0, 0.2, 0],
            "detail": 12,
        },
        {"name": "materials", "shape": "box", "at": [0, -0.6, 0]},
    ],
}


def moving() -> dict[str, Any]:
    """The same with obstacles of which one moves, at 2 steps a frame."""
    scene: dict[str, Any] = json.loads(json.dumps(STILL))
    scene["motions"] = [
        {"name": "push", "keys": [{"time": 0}, {"time": 1, "move": [0, 0.1, 0.3]}]}
    ]
    scene["obstacles"][0]["motion"] = "push"
    scene.update(name="7 pushed", dt=1 / 48, steps_per_frame=2)
    return scene


def tool() -> Path:
    """The tool; the test is skipped where nobody has built it."""
    path = Path(os.environ.get("DRAPE_TOOL", ROOT / "build" / "drape"))
    if not path.exists():
        pytest.skip(f"{path} is not built: make, or name it by DRAPE_TOOL")
    return path


def sew(folder: Path, frames: int, attach: Any = (), *options: str) -> Path:
    """Sews a T-shirt in cells of 40 mm about a capsule, and returns the run's folder.
    Its seams close within 60 frames."""
    chest = {"shape": "capsule", "radius": 0.12, "length": 0.6, "at": [0, 1.12, 0]}
    garment = {"pattern": str(ROOT / "app/patterns/tee.json"), "cell": 0.04}
    garment |= {"attach": attach} if attach else {}
    scene = {"name": "tee", "garments": [garment], "obstacles": [chest]}
    file, run = folder / "scene.json", folder / "run"
    file.write_text(json.dumps(scene))
    command = [tool(), "sew", file, "--frames", str(frames), "--out", run]
    command += options
    done = subprocess.run(command, capture_output=True, text=True)
    # it fails where seams are open, and has written all the same
    assert (run / "sewn.json").exists(), done.stderr
    return run


def make(folder: Path, scene: dict[str, Any], *options: str) -> Path:
    """Runs a scene by the tool, and returns the folder that it writes."""
    file = folder.with_suffix(".json")
    file.write_text(json.dumps(scene))
    command = [tool(), "run", file, "--out", folder, *options]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder
