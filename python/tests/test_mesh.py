# SPDX-License-Identifier: Apache-2.0
"""Exact queries."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drape

FACE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_audit_finds_pairs() -> None:
    x = np.array([*FACE, [0.2, 0.2, -1], [0.3, 0.2, -1], [0.2, 0.2, 1], *FACE])
    x[6:] += [0, 0, 5]
    tri = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [6, 6, 7]]
    found = drape.audit(x, tri)
    assert found.pairs.tolist() == [[0, 1]] and found.degenerate == 1
    assert drape.audit(x, tri, group=[0, 0, 0, 0]).count == 0
    assert drape.audit(x, tri, group=[0, 1, 0, 0]).count == 1


def test_audit_of_many_pairs() -> None:
    rng = np.random.default_rng(1)
    tri = np.arange(900).reshape(300, 3)
    found = drape.audit(rng.random((900, 3)), tri)
    assert found.count > 1024  # more than the first buffer holds
    assert (np.diff(found.pairs[:, 0]) >= 0).all()


def test_audit_refuses() -> None:
    with pytest.raises(drape.SceneError, match="audit"):
        drape.audit(np.zeros((3, 3)), [[0, 1, 3]])
    with pytest.raises(drape.SceneError, match="finite"):
        drape.audit(np.full((3, 3), np.inf), [[0, 1, 2]])
    with pytest.raises(drape.SceneError, match=r"vertices: 3 × 2"):
        drape.audit(np.zeros((3, 2)), [[0, 1, 2]])
    with pytest.raises(drape.SceneError, match=r"triangles: .*in range"):
        drape.audit(np.zeros((3, 3)), [[0, 1, 2**40]])


def test_ccd() -> None:
    start = np.array([[0.25, 0.25, 1], *FACE])
    end, miss = start.copy(), start.copy()
    end[0, 2], miss[0, :2] = -1, 2
    toi = drape.ccd("vf", start, end)
    assert 0.5 - 2**-30 <= toi <= 0.5
    both = drape.ccd("vf", np.stack([start, start]), np.stack([miss, end]))
    assert np.isnan(both[0]) and both[1] == toi
    edges = np.array([[0, 0, 0], [1, 0, 0], [0.5, -1, 1], [0.5, 1, 1]], float)
    later = edges - [[0, 0, 0], [0, 0, 0], [0, 0, 2], [0, 0, 2]]
    assert 0.5 - 2**-30 <= drape.ccd("ee", edges, later) <= 0.5
    with pytest.raises(drape.SceneError, match="kind 'fv'"):
        drape.ccd("fv", start, end)
    end[2, 1] = np.nan
    with pytest.raises(drape.SceneError, match="query 1"):
        drape.ccd("vf", np.stack([start, start]), np.stack([miss, end]))


def ply(path: Path, x: np.ndarray, tri: list[list[int]]) -> Path:
    rows = [" ".join(map(repr, map(float, row))) for row in x]
    rows += ["3 " + " ".join(map(str, row)) for row in tri]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(x)}\n"
    head += "".join(f"property double {c}\n" for c in "xyz")
    head += f"element face {len(tri)}\nproperty list uchar int vertex_indices\n"
    path.write_text(head + "end_header\n" + "\n".join(rows) + "\n")
    return path


def test_ccd_mesh_is_the_tools(tmp_path: Path) -> None:
    x0 = np.array([*FACE, [0.2, 0.2, 1], [0.3, 0.2, 2], [0.2, 0.3, 2]])
    x1 = x0.copy()
    x1[3:, 2] -= 2.5
    tri = [[0, 1, 2], [3, 4, 5]]
    found = drape.ccd_mesh(x0, x1, tri)
    a, b = ply(tmp_path / "a.ply", x0, tri), ply(tmp_path / "b.ply", x1, tri)
    rows = [
        line.split() for line in drape.tool.call("ccd", "--frames", a, b).split("\n")
    ]
    theirs = [
        (row[0], [int(word) for word in row[1:5]]) for row in rows if len(row) >= 5
    ]
    ours = [
        ("vf" if kind == 0 else "ee", row.tolist())
        for kind, row in zip(found.kind, found.vertices, strict=True)
    ]
    assert ours == theirs and len(ours) >= 3
    assert found.toi[0] == pytest.approx(0.4, abs=1e-9)
    assert found.candidates[0] >= (found.kind == 0).sum()
    still = drape.ccd_mesh(x0, x0, tri)
    assert len(still.kind) == 0 and still.vertices.shape == (0, 4)
