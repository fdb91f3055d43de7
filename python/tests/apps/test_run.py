# SPDX-License-Identifier: Apache-2.0
"""Reading a run's folder, and the command line of `drape export`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from needs import need

import drape
from apps.runs import tool
from drape.export import Run, RunError, mesh
from drape.export.cli import FORMATS, export, main
from drape.export.run import read_ply


def test_bodies_are_those_of_the_scene(still: Path) -> None:
    run = Run(still)
    assert [(b.name, b.kind, b.moving) for b in run.bodies] == [
        ("sheet é", "cloth", True),
        ("sheet é", "cloth", True),
        ("ball", "obstacle", False),
        ("materials", "obstacle", False),
    ]
    assert (run.fps, run.precision, run.end) == (60, 32, "complete")
    assert run.frames() == list(range(9))


def test_rows_of_the_bodies_are_those_of_the_frames(still: Path) -> None:
    run = Run(still)
    x, tri = read_ply(still / "frames" / "cloth_0005.ply")
    assert len(x) == 13 * 9 + 81 and x.dtype == np.float32
    first, second = run.bodies[:2]
    got = [run.positions(b, 5)[b.faces] for b in (first, second)]
    assert np.array_equal(np.concatenate(got), x[tri])


def test_holes_leave_no_stray_vertices(still: Path) -> None:
    sheet = Run(still).bodies[0]
    assert len(sheet.rows) < 13 * 9
    assert np.array_equal(np.unique(sheet.faces), np.arange(len(sheet.rows)))


def test_uvs_are_places_on_the_grid(still: Path) -> None:
    run = Run(still)
    for body in run.bodies[:2]:
        assert body.uv is not None and body.size is not None
        assert body.uv.min() == 0 and body.uv.max() == 1
        # at the start a sheet lies flat, so places and positions agree
        x = run.positions(body, 0)
        flat = (x - x[0])[:, [0, 2]]
        assert np.allclose(body.uv * body.size, flat, atol=1e-6)


def test_frames_that_were_left_out(pushed: Path) -> None:
    run = Run(pushed)
    assert run.frames() == [0, 2, 4, 6, 8] and run.fps == 24
    assert [b.moving for b in run.bodies] == [True, True, True, False]
    ball = run.bodies[2]
    moved = run.positions(ball, 8) - run.positions(ball, 0)
    assert np.allclose(moved, [0, 0.1 / 3, 0.1], atol=1e-6)


def test_64_bits_stay_64(wide: Path) -> None:
    run = Run(wide)
    assert run.positions(run.bodies[0], 1).dtype == np.float64


def test_normals_of_a_box_are_its_faces(still: Path) -> None:
    run = Run(still)
    x, faces = run.positions(run.bodies[3], 0), run.bodies[3].faces
    normal = mesh.corner_normals(x, faces, mesh.sharp_corners(x, faces))
    assert np.array_equal(np.abs(normal).max(2), np.ones(faces.shape, np.float32))


def test_normals_of_a_ball_are_round(still: Path) -> None:
    run = Run(still)
    x, faces = run.positions(run.bodies[2], 0), run.bodies[2].faces
    assert not mesh.sharp_corners(x, faces).any()
    away = (x - [0, 0.2, 0]) / 0.15
    assert np.allclose(mesh.vertex_normals(x, faces), away, atol=0.05)


def test_colours_are_those_of_render() -> None:
    root = Path(__file__).resolve().parents[3]
    paint = (root / "app/render/paint.c").read_text()
    for rgb in mesh.CLOTHS:
        digits = [f"{c:.3f}".lstrip("0").rstrip("0") for c in rgb]
        assert any(
            all(d in line for d in digits)
            for line in paint.splitlines()
            if line.startswith("    {{")
        ), rgb
    files = ("picture.c", "model.c")
    stone = "".join((root / "app/render" / f).read_text() for f in files)
    assert "make(.60f, .555f, .49f)" in stone and mesh.STONE == (0.60, 0.555, 0.49)


def test_a_colour_of_the_scene_is_taken(still: Path, tmp_path: Path) -> None:
    look = "r['bodies'][2]['look'] = {'colour': [0, 0.5, 1], 'check': False}"
    run = Run(spoil(still, tmp_path / "run", "report.json", look))
    assert np.allclose(mesh.colour(run.bodies[2], 2), [0, 0.21404, 1], atol=1e-5)
    assert mesh.colour(run.bodies[3], 3) == mesh.STONE


def test_identifiers_differ() -> None:
    assert mesh.identifiers(["a b", "a_b", "7", "", "a b"]) == [
        "a_b",
        "a_b_2",
        "_7",
        "_",
        "a_b_3",
    ]


def spoil(folder: Path, to: Path, name: str, change: str) -> Path:
    """A copy of a run of which one file is damaged."""
    shutil.copytree(folder, to)
    file = to / name
    if change == "gone":
        file.unlink()
    elif change == "cut":
        file.write_bytes(file.read_bytes()[:-3])
    elif change == "other":
        file.write_bytes((to / "obstacles.ply").read_bytes())
    else:
        report = json.loads(file.read_text())
        exec(change, {"r": report})
        file.write_text(json.dumps(report))
    return to


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("report.json", "gone"),
        ("report.json", "cut"),
        ("report.json", "r.pop('bodies')"),
        ("report.json", "r['bodies'][1]['particles'] = 3"),
        ("report.json", "r['dt'] = 0"),
        ("report.json", "r['bodies'][2]['first_vertex'] += 1"),
        ("frames/cloth_0003.ply", "cut"),
        ("frames/cloth_0003.ply", "other"),
        ("obstacles.ply", "cut"),
    ],
)
def test_a_damaged_run_is_one_line(
    still: Path,
    tmp_path: Path,
    name: str,
    change: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    need("pygltflib")
    folder = spoil(still, tmp_path / "run", name, change)
    assert main([str(folder), "--to", str(tmp_path / "x.glb")]) == 2
    out, err = capsys.readouterr()
    assert not out and err.count("\n") == 1 and name in err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--to", "x.fbx"], "x.fbx: expected a name that ends in"),
        (["--to", "nowhere/x.usdc"], "nowhere"),
        (["--to", "x.usdc", "--every", "0"], "--every"),
        ([], "--to"),
    ],
)
def test_a_wrong_command_line_is_one_line(
    still: Path,
    arguments: list[str],
    words: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    try:
        code = main([str(still), *arguments])
    except SystemExit as end:
        code = int(str(end.code))
    out, err = capsys.readouterr()
    assert code == 2 and not out and err.count("\n") == 1 and words in err


def test_quiet_says_nothing(
    still: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    need("pygltflib")
    file = tmp_path / "x.glb"
    assert main([str(still), "--to", str(file), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "") and file.stat().st_size > 0


def test_a_run_may_be_given_by_its_folder(still: Path, tmp_path: Path) -> None:
    need("pygltflib")
    files = [tmp_path / "a.glb", tmp_path / "b.glb"]
    assert export(Run(still), files[0]) == export(still, files[1]) == 9
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_package_that_is_missing_is_named(
    still: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(FORMATS, ".glb", ("no_such_writer", "some-package"))
    with pytest.raises(drape.Error, match="pip install some-package"):
        export(Run(still), tmp_path / "x.glb")


def test_a_fault_while_writing_leaves_what_was_there(
    still: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("pygltflib")
    file = tmp_path / "x.glb"
    file.write_text("old")
    run = Run(still)
    bad = [*run.frames(), 99]
    monkeypatch.setattr(run, "frames", lambda: bad)
    with pytest.raises(RunError, match="cloth_0099"):
        export(run, file)
    assert file.read_text() == "old" and len(list(tmp_path.iterdir())) == 1


def test_the_tool_becomes_python(still: Path, tmp_path: Path) -> None:
    need("pygltflib")
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    (tmp_path / "json.py").write_text("raise SystemExit('the wrong module')")
    file = tmp_path / "run file.glb"
    done = subprocess.run(
        [tool(), "export", still, "--to", file],
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{file}: 9 frames, 60 a second\n" and file.exists()
