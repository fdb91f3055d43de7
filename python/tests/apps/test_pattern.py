# SPDX-License-Identifier: Apache-2.0
"""The panels of a run of `drape sew`, flat, and the seams that join them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from needs import need

import drape
from apps.runs import STILL, make, sew
from drape.export.cli import export
from drape.export.run import Body, Run
from drape.viewer import strain
from drape.viewer.live import Live
from drape.viewer.pattern import GROUND, HELD, Pattern, Side, colour_of, perceived
from drape.viewer.source import Recorded


def pattern_of(source: Recorded | Live) -> Pattern:
    """The pattern of a source that has one."""
    assert source.pattern
    return source.pattern


def ends(side: Side, x: np.ndarray) -> np.ndarray:
    """The places of a side, [points, 3] m."""
    lines = side.lines(x)
    return np.concatenate([lines[:, 0], lines[-1:, 1]])


def test_the_sides_of_a_seam_meet_where_it_is_sewn(sewn: Path) -> None:
    source, about = Recorded(sewn), json.loads((sewn / "sew.json").read_text())
    pattern, last = pattern_of(source), source.frames()[-1]
    assert [s.name for s in pattern.seams] == [s["name"] for s in about["seams"]]
    assert len({s.colour for s in pattern.seams}) == len(pattern.seams) == 10
    for seam, row in zip(pattern.seams, about["seams"], strict=True):
        at = [source.positions(source.bodies[s.body], last) for s in seam.sides]
        gap = ends(seam.sides[0], at[0]) - ends(seam.sides[1], at[1])
        widest = np.linalg.norm(gap, axis=1).max()
        assert abs(widest - row["gap_m"]) < 1e-5  # frames have 32 bits
        assert seam.end == f"closed in step {row['closed']}"
        first = [source.positions(source.bodies[s.body], 0) for s in seam.sides]
        apart = ends(seam.sides[0], first[0]) - ends(seam.sides[1], first[1])
        assert np.linalg.norm(apart, axis=1).max() > 0.01


def test_panels_lie_flat_as_they_are_cut(sewn: Path) -> None:
    source = Recorded(sewn)
    pattern = pattern_of(source)
    flat = pattern.lay(0.7)
    boxes = [(x.min(0), x.max(0)) for x in flat.values()]
    for k, (low, high) in enumerate(boxes):
        assert (low >= 0).all()
        for below, above in boxes[:k]:  # they do not overlap
            assert (low > above).any() or (high < below).any()
    for k, x in flat.items():
        body = source.bodies[k]
        rest = np.pad(x, ((0, 0), (0, 1)))
        least, largest = strain.principal(body, rest)
        assert max(-least.min(), largest.max()) < 1e-5
        # borders are not where the grid has them, by which strain was measured
        assert body.rest is not None and body.grid is not None and body.size is not None
        cells = body.rest / body.size * (np.array(body.grid) - 1)
        assert np.abs(cells - np.round(cells)).max() > 0.3


def test_contacts_of_a_sewn_garment_are_had_by_its_scene(sewn: Path) -> None:
    source = Recorded(sewn)
    assert source.contacts(0) is None
    assert str(sewn / "sewn.json") in source.no_contacts
    live = Live(sewn / "sewn.json", paced=True)
    try:
        assert live.contacts(0) is not None
    finally:
        live.close()


def test_a_live_scene_has_the_pattern_of_its_run(sewn: Path) -> None:
    live, run = Live(sewn / "sewn.json", paced=True), Recorded(sewn)
    try:
        mine, theirs = pattern_of(live), pattern_of(run)
        for k, x in mine.rest.items():
            assert np.array_equal(x, theirs.rest[k])
        for a, b in zip(mine.seams, theirs.seams, strict=True):
            assert a.colour == b.colour
            assert np.array_equal(a.sides[1].ends, b.sides[1].ends)
        assert mine.seams[0].name == "front to back"
    finally:
        live.close()


def test_a_run_without_garments_has_none(still: Path) -> None:
    source = Recorded(still)
    assert source.pattern is None and source.bodies is source.run.bodies
    assert not (still / "rest.ply").exists() and not (still / "seams.json").exists()


def test_a_run_has_the_pattern_of_its_garments(sewn: Path, tmp_path: Path) -> None:
    scene = json.loads((sewn / "sewn.json").read_text())
    scene["garments"][0]["sewn"] = str(sewn / scene["garments"][0]["sewn"])
    source = Recorded(make(tmp_path / "worn", scene, "--frames", "2"))
    mine, theirs = pattern_of(source), pattern_of(Recorded(sewn))
    assert [k for k in mine.rest] == [k for k in theirs.rest]
    for k, x in mine.rest.items():
        assert np.array_equal(x, theirs.rest[k])
    for a, b in zip(mine.seams, theirs.seams, strict=True):
        assert (a.name, a.colour) == (b.name, b.colour) and not a.end
        assert np.array_equal(a.sides[1].ends, b.sides[1].ends)
    assert "drape run --contacts" in source.no_contacts
    # a run that another one replaces leaves nothing of its own
    folder = make(tmp_path / "worn", STILL, "--force", "--frames", "1")
    assert Recorded(folder).pattern is None and not (folder / "rest.ply").exists()


def test_attachments_are_on_the_pattern(tmp_path: Path) -> None:
    source = Recorded(sew(tmp_path, 60, [{"label": "neck", "to": "world"}]))
    pattern = pattern_of(source)
    rows = json.loads((source.run.folder / "sew.json").read_text())
    assert len(pattern.attachments) == len(rows["attachments"]) > 0
    for each, row in zip(pattern.attachments, rows["attachments"], strict=True):
        assert each.name == row["name"] and len(np.unique(each.edges)) == row["points"]
        assert each.end == f"held from step {row['from']}"
        x = pattern.rest[each.body][each.edges]
        assert 0 < np.linalg.norm(x[:, 1] - x[:, 0], axis=1).max() < 0.12
        assert each.name in pattern.legend()
    lines, colours = pattern.lines(lambda k: np.pad(pattern.rest[k], ((0, 0), (0, 1))))
    held = (colours == HELD).all((1, 2)).sum()
    assert held == sum(len(each.edges) for each in pattern.attachments)
    assert len(lines) == len(colours)


def test_an_open_seam_says_by_how_much(tmp_path: Path) -> None:
    source = Recorded(sew(tmp_path, 5))
    pattern = pattern_of(source)
    assert all(s.end.startswith("open by ") for s in pattern.seams)
    assert "open by" in pattern.legend() and "front 1 to back 7" in pattern.legend()


def test_colours_of_seams_differ() -> None:
    lab = perceived(np.array([*(colour_of(k) for k in range(48)), GROUND, HELD]))
    apart = np.linalg.norm(lab[:, None] - lab, axis=-1) + 9 * np.eye(len(lab))
    ten = [*range(10), 48, 49]
    assert apart[np.ix_(ten, ten)].min() > 0.18  # was 0.07, of two greens
    assert apart.min() > 0.08


def lengths(x: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Of the sides of triangles, [triangles, 3]."""
    corner = x.astype(np.float64)[faces]
    return np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)


def flat(uv: np.ndarray, body: Body, faces: np.ndarray) -> np.ndarray:
    """The same by places on a cloth of a size."""
    return lengths(uv[:, :2] * np.array(body.size), faces)


def lies_flat(run: Run, body: Body) -> bool:
    """Whether a body is a cloth that begins in a plane, and so as it is cut."""
    x = run.positions(body, 0)
    return body.kind == "cloth" and np.linalg.svd(x - x.mean(0))[1][2] < 1e-5


def test_files_have_panels_as_they_are_cut(sewn: Path, tmp_path: Path) -> None:
    """Sewing begins with panels as large as at rest; front and back are flat."""
    need("pygltflib")
    from pxr import Usd, UsdGeom

    from apps.test_gltf import Glb

    run = Run(sewn)
    for ending in ("glb", "usdc", "npz"):
        export(run, tmp_path / f"run.{ending}")
    export(run, tmp_path / "frame_%04d.vtu")
    assert sum(lies_flat(run, body) for body in run.bodies) == 2
    glb, stage = Glb(tmp_path / "run.glb"), Usd.Stage.Open(str(tmp_path / "run.usdc"))
    meshes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    arrays = np.load(tmp_path / "run.npz")
    vtu = need("meshio").read(tmp_path / "frame_0000.vtu").point_data["uv"]
    for k, body in enumerate(run.bodies):
        if not lies_flat(run, body):
            continue
        first, last = arrays["body_vertices"][k]
        cut = lengths(run.positions(body, 0), body.faces)
        assert (
            np.abs(flat(arrays["uv"][first:last], body, body.faces) - cut).max() < 1e-5
        )
        rest = lengths(arrays["rest"][first:last], body.faces)
        assert np.abs(rest - cut).max() < 1e-6
        assert np.abs(flat(vtu[first:last], body, body.faces) - cut).max() < 1e-5
        st = UsdGeom.PrimvarsAPI(meshes[k]).GetPrimvar("st").Get()
        assert np.abs(flat(np.array(st), body, body.faces) - cut).max() < 1e-5
        part = glb.root["meshes"][k]["primitives"][0]
        uv = glb.array(part["attributes"]["TEXCOORD_0"])
        faces = glb.array(part["indices"]).reshape(-1, 3)
        assert np.abs(flat(uv, body, faces) - cut).max() < 1e-5


def test_obj_files_have_panels_as_they_are_cut(tmp_path: Path) -> None:
    run = Run(sew(tmp_path, 1, [], "--obj"))
    text = (run.folder / "frames/cloth_0000.obj").read_text()
    rows = [line.split() for line in text.splitlines()]
    x, uv = (
        np.array([row[1:] for row in rows if row[0] == key], float)
        for key in ("v", "vt")
    )
    tri = np.array(
        [[w.split("/")[0] for w in row[1:]] for row in rows if row[0] == "f"], int
    )
    at = 0
    for body in run.bodies:
        if body.kind == "cloth":
            faces = tri[at : at + len(body.faces)] - 1
            at += len(faces)
            if lies_flat(run, body):
                assert np.abs(flat(uv, body, faces) - lengths(x, faces)).max() < 1e-5
    assert at == len(tri) > 100


def test_a_world_knows_panels_at_rest(sewn: Path) -> None:
    world = drape.World(drape.Scene.load(sewn.parent / "scene.json"))
    for body in world.bodies[:2]:  # which begin in a plane
        x, tri = world.positions[body.vertices], world.triangles[body.triangles]
        faces = tri - body.vertices.start
        assert np.abs(lengths(body.rest, faces) - lengths(x, faces)).max() < 1e-6
