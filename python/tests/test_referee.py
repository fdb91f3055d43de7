# SPDX-License-Identifier: Apache-2.0
"""Frames of other programs are audited: what intersects, and what passes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape
from drape.__main__ import main

FLOOR = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
FACES = [[0, 2, 1], [0, 3, 2]]
SHARD = np.array([[0.2, 0, 0.1], [0.3, 0, 0.1], [0.2, 0, 0.15]], float)


def drop(heights: list[float]) -> np.ndarray[Any, Any]:
    """A level triangle at these heights above a square, [f, 7, 3]."""
    return np.stack(
        [np.concatenate([FLOOR, np.add(SHARD, [0, y, 0])]) for y in heights]
    )


TRI = [*FACES, [4, 5, 6]]


def test_frames_that_intersect_and_ways_that_pass() -> None:
    frames = drop([0.5, 0.25, -0.25, -0.5])
    frames[3, 4, 1] = 0.5  # a corner of the triangle sticks up through the square
    found = drape.audit_frames(frames, TRI, between=True)
    assert [each.pairs for each in found] == [0, 0, 0, 1]
    assert [each.passing for each in found[:2]] == [None, 0]
    assert found[2].passing and found[3].passing
    assert [each.passing for each in drape.audit_frames(frames, TRI)] == [None] * 4
    still = drape.audit_frames(frames, TRI, [0, 0, 0], between=True)
    assert all(each.pairs == 0 and not each.passing for each in still)
    with pytest.raises(drape.SceneError, match="frames: 7 × 3; expected n × n × 3"):
        drape.audit_frames(frames[0], TRI)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.npz"
    np.savez(file, frames=drop([0.5, 0.25, -0.25]), faces=TRI)
    assert main(["audit", str(file)]) == 0
    assert capsys.readouterr().out == (
        f"{file}: 3 frames, 0 of them with intersecting pairs, 0 pairs\n"
    )
    assert main(["audit", str(file), "--between"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert "; 3 touch on the way from frame 1" in lines[0]
    assert lines[1].endswith("; 2 ways, 1 of them with pairs that touch, 3 pairs")
    assert main(["audit", str(file), "--list"]) == 0
    assert capsys.readouterr().out.count("\n") == 4


def test_files_of_a_frame_each(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world = drape.World({"cloths": [{"particles": [5, 5]}]}, gravity=[0, -9, 0])
    files = []
    for k in range(3):
        files.append(str(world.export(tmp_path / f"f_{k}.ply")))
        world.step()
    np.savez(tmp_path / "floor.npz", vertices=FLOOR - [0, 0.005, 0], faces=FACES)
    floor = ["--obstacle", str(tmp_path / "floor.npz")]
    assert main(["audit", "--frames", *files]) == 0
    assert capsys.readouterr().out.startswith("3 files: 3 frames, 0 of them")
    assert main(["audit", "--between", "--frames", *files, *floor]) == 1
    assert "ways, 1 of them with pairs that touch" in capsys.readouterr().out
    other = drape.World({"cloths": [{"particles": [6, 5]}]})
    more = str(other.export(tmp_path / "g.ply"))
    assert main(["audit", "--frames", files[0], more]) == 2
    assert "g.ply: other triangles than those of" in capsys.readouterr().err
    assert main(["audit", "--frames", str(tmp_path / "none.ply")]) == 2
    assert "none.ply: there is no such file" in capsys.readouterr().err
