# SPDX-License-Identifier: Apache-2.0
"""Garments sewn from Python: what the tool wrote is what the objects say."""

from __future__ import annotations

import gc
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drape
from drape._meshes import ply

SIDE = 20  # cm


@pytest.fixture
def flaps(tmp_path: Path) -> Path:
    """A pattern of two squares, 4 cm apart, and a seam of their upper edges."""
    corners = [[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]]
    edges = [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]
    panel = {"vertices": corners, "edges": edges}
    front = {**panel, "translation": [-SIDE / 2, 0, 2]}
    back = {**panel, "translation": [SIDE / 2, 0, -2], "rotation": [0, 180, 0]}
    sides = [{"panel": name, "edge": 2} for name in ("front", "back")]
    pattern = {"panels": {"front": front, "back": back}, "stitches": [sides]}
    file = tmp_path / "flaps.json"
    properties = {"units_in_meter": 100}
    file.write_text(json.dumps({"pattern": pattern, "properties": properties}))
    return file


def rail(**keys: Any) -> drape.Obstacle:
    """A bar along x, below the upper edges of both squares."""
    bar = {"shape": "capsule", "radius": 0.012, "length": 0.4, "at": [0, 0.15, 0]}
    turn = {"axis": [0, 0, 1], "angle": 90}
    return drape.Obstacle(**{"name": "rail", **bar, **turn, **keys})


def test_a_garment_is_sewn_and_goes_on(flaps: Path, tmp_path: Path) -> None:
    said: list[str] = []
    out = tmp_path / "out"
    sewn = drape.sew(
        flaps,
        rail(),
        cell=0.02,
        material="denim",
        folder=out,
        frames=30,
        threads=1,
        log=said.append,
    )
    written = json.loads((out / "sew.json").read_text())
    (seam,) = sewn.seams
    assert (seam.name, seam.stage, seam.points) == ("front 2 to back 2", "around", 11)
    assert seam.closed and seam.gap < 0.05 * 0.02 and seam.pull > 0
    assert seam.gap == written["seams"][0]["gap_m"]
    assert sewn.open == [] and sewn.clean and sewn.outcome == drape.Outcome(0)
    assert sewn.stages == {"around": 0, "worn": written["stages"]["worn"]}
    assert len(sewn.frames) == sewn.steps + 1
    assert [each.stage for each in sewn.frames[:: sewn.steps]] == ["around", "worn"]
    assert sewn.frames[0].gap_cells > 1 > sewn.frames[-1].gap_cells
    assert list(sewn.pictures) == ["front", "back"]
    assert all(file.read_bytes()[1:4] == b"PNG" for file in sewn.pictures.values())
    assert any("1 of 1 seams open" in line for line in said)
    # it goes on, bit for bit, from where the particles are
    assert sewn.positions.shape == (2 * 11 * 11, 3)
    world = sewn.world(threads=1)
    assert np.array_equal(world.positions[: len(sewn.positions)], sewn.positions)
    gap, _ = world.seam(0)
    assert np.linalg.norm(gap, axis=1).max() == pytest.approx(seam.gap, rel=1e-4)
    assert world.step(5).clean
    assert sewn.scene.garments
    assert [each.name for each in sewn.run.bodies] == ["front", "back", "rail"]
    assert repr(sewn).startswith("<drape.Sewn: 1 of 1 seams closed, ")
    # a folder that holds a garment is not taken for another one
    with pytest.raises(drape.SceneError, match=r"out: holds sew\.json; .*force=True"):
        drape.sew(flaps, folder=out)
    assert drape.Sewn(out).seams == sewn.seams


def test_bodies_in_any_form(
    flaps: Path, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    """A scene, arrays and files in folders of their own give the same bits, and no
    word but what the object says."""
    monkeypatch.chdir(flaps.parent)
    mesh = drape.World({"cloths": [{}], "obstacles": [rail()]}, precision=64)
    part = mesh.bodies[1]
    x = mesh.read()[0][part.vertices]
    tri = mesh.triangles[part.triangles] - part.vertices.start
    how: dict[str, Any] = {"frames": 8, "pictures": False, "precision": 64}
    arrays = drape.Obstacle(vertices=x, triangles=tri)
    ends = [
        drape.sew("flaps.json", body, cell=0.04, **how).positions
        for body in (rail(), [drape.scene.as_dict(rail())], arrays, (x, tri))
    ]
    garment = {"pattern": "flaps.json", "cell": 0.04}
    scene = {"garments": [garment], "obstacles": [rail()]}
    ends.append(drape.sew(scene, **how).positions)
    assert not recwarn.list and ends[0].dtype == np.float64
    assert all(np.array_equal(ends[0], each) for each in ends)
    file = flaps.parent / "scenes/worn.json"
    file.parent.mkdir()
    garment["pattern"] = "../flaps.json"
    drape.Scene(**scene).save(file)
    sewn = drape.sew(file, **how)
    assert np.array_equal(ends[0], sewn.positions) and not sewn.pictures
    place = sewn.folder
    del sewn
    gc.collect()
    assert not place.exists()  # a folder of its own goes with it


def test_edges_are_held_by_their_labels(flaps: Path) -> None:
    """The upper edge of one flap, in the air: softly to the end, or for a while."""
    tree = json.loads(flaps.read_text())
    edges = tree["pattern"]["panels"]["front"]["edges"] = [
        dict(edge) for edge in tree["pattern"]["panels"]["front"]["edges"]
    ]
    edges[2]["label"] = "rim"
    flaps.write_text(json.dumps(tree))
    how: dict[str, Any] = {"cell": 0.02, "frames": 60, "pictures": False}
    sewn = drape.sew(flaps, attach=[drape.Attach(label="rim")], **how)
    (row,) = sewn.attachments
    assert (row.name, row.body, row.hold, row.points) == ("front rim", None, "soft", 11)
    assert row.began and row.ended is None and row.slip < 1e-4 and 0 < row.pull < 30
    rim = {"label": "rim", "to": "world", "hold": "hard", "until": 0.5}
    freed = drape.sew(flaps, attach=[rim], **how)
    (row,) = freed.attachments
    assert row.hold == "hard" and row.began and row.ended == row.began + 30
    fallen = freed.positions[:121, 1].max()  # of front alone
    assert fallen < sewn.positions[:121, 1].max() - 0.02
    assert not drape.sew(flaps, **{**how, "frames": 1}).attachments
    with pytest.raises(drape.SceneError, match=r'no edge .* "rin"; did you mean "rim"'):
        drape.sew(flaps, attach=[drape.Attach(label="rin")], **how)
    with pytest.raises(drape.SceneError, match="attach: it is for a pattern"):
        drape.sew({"garments": [{"pattern": str(flaps)}]}, attach=[])


def test_the_garment_follows_a_body_that_moves(flaps: Path, tmp_path: Path) -> None:
    """The rail rises by 2 cm in the frames of a point cache, from where the mesh is or
    after the second in which the mesh goes there; and in numbered files."""
    world = drape.World({"cloths": [{}], "obstacles": [rail()]})
    part = world.bodies[1]
    x = world.read()[0][part.vertices].astype(np.float32)
    tri = world.triangles[part.triangles] - part.vertices.start
    up = np.array([0, 0.02, 0], np.float32)
    file, cache, late = (tmp_path / name for name in ("rail.ply", "up.pc2", "late.pc2"))
    file.write_bytes(ply(x, tri))
    poses = [x, x + up / 2, x + up]
    for name, frames in ((cache, poses), (late, poses[1:])):
        head = struct.pack("<12siiffi", b"POINTCACHE2", 1, len(x), 0, 1, len(frames))
        name.write_bytes(head + np.stack(frames).astype("<f4").tobytes())
    for k, pose in enumerate(poses):
        (tmp_path / f"up_{k}.ply").write_bytes(ply(pose, tri))
    how: dict[str, Any] = {"cell": 0.04, "frames": 30, "pictures": False, "rate": 6}
    sewn = drape.sew(flaps, file, motion=cache, **how)
    assert sewn.stages["moving"] == 30 and sewn.steps == 50 and sewn.clean
    assert [each.stage for each in sewn.frames[30:32]] == ["worn", "moving"]
    assert sewn.end == "complete" and not sewn.open
    front, back, body = sewn.run.bodies

    def at(made: drape.Sewn, frame: int, of: Any = body) -> Any:
        return made.run.positions(of, frame)

    assert np.array_equal(at(sewn, 30), x) and np.array_equal(at(sewn, 50), poses[2])
    assert at(sewn, 50, front)[:, 1].max() > poses[2][:, 1].max()
    worn = np.concatenate([at(sewn, 30, each) for each in (front, back)])
    assert np.array_equal(worn, sewn.positions)
    files = drape.sew(flaps, file, motion=tmp_path / "up_%d.ply", **how)
    assert np.array_equal(at(files, 50, front), at(sewn, 50, front))
    led = drape.sew(flaps, file, motion=late, **how)
    assert led.steps == 30 + 60 + 10 and led.clean
    assert np.array_equal(at(led, 30), x) and np.array_equal(at(led, 90), poses[1])
    still = drape.sew(sewn.scene, motion=False, pictures=False, frames=30)
    assert "moving" not in still.stages
    with pytest.raises(
        drape.SceneError, match=r"^motion: expected a body, the file of a mesh"
    ):
        drape.sew(flaps, rail(), motion=cache)
    with pytest.raises(drape.SceneError, match=r"^rate: 0: expected frames a second"):
        drape.sew(flaps, file, motion=cache, rate=0)
    with pytest.raises(drape.SceneError, match=r"^motion: it is for a pattern"):
        drape.sew(sewn.scene, motion=cache)


def test_a_seam_that_cannot_close_is_told(flaps: Path) -> None:
    """A board between the panels, wider than both, keeps their edges apart."""
    board = drape.Obstacle(shape="box", extent=[0.3, 0.4, 0.02], at=[0, 0.1, 0])
    sewn = drape.sew(flaps, board, cell=0.02, frames=30, pictures=False)
    (seam,) = sewn.open
    assert seam.gap > 0.02 and seam.closed is None
    assert 0 < seam.waiting <= 11 and seam.pull == pytest.approx(30, rel=1e-3)
    assert sewn.stages == {"around": 0} and sewn.end == "complete" and sewn.clean


def test_what_is_refused(flaps: Path, tmp_path: Path) -> None:
    """Each by one line that says what, with the names that the caller gave."""
    how: dict[str, Any] = {"frames": 0, "pictures": False}
    with pytest.raises(drape.SceneError, match=r"^none\.json: No such file"):
        drape.sew("none.json")
    with pytest.raises(drape.SceneError, match=r"^cell: it is for a pattern"):
        drape.sew({"garments": [{"pattern": str(flaps)}]}, cell=0.02)
    with pytest.raises(drape.SceneError, match=r"^scene: .*cell"):
        drape.sew(flaps, cell=20, **how)
    with pytest.raises(drape.SceneError, match=r"nylonn"):
        drape.sew(flaps, material="nylonn", **how)
    with pytest.raises(drape.SceneError, match="there is no seam to sew"):
        drape.sew({"cloths": [{"particles": [5, 5]}]}, **how)
    with pytest.raises(drape.SceneError, match="no arrays of cloths"):
        cloth = {"particles": [2, 2], "positions": np.zeros((4, 3))}
        drape.sew({"cloths": [cloth], "garments": [{"pattern": str(flaps)}]}, **how)
    with pytest.raises(drape.SceneError, match=r"body\.obj"):
        drape.sew(flaps, "body.obj", **how)
    (tmp_path / "run").mkdir()
    drape.World({"cloths": [{}]}).record(tmp_path / "run").close()
    with pytest.raises(drape.SceneError, match=r"holds a run; .*force=True"):
        drape.sew(flaps, folder=tmp_path / "run", **how)
    # goes through both squares, and is too long for them to leave it
    beam = drape.Obstacle(
        name="beam", shape="box", extent=[0.1, 0.1, 1], at=[0, 0.15, 0]
    )
    for _ in range(2):  # what was refused leaves its folder free
        with pytest.raises(drape.Error, match="begins in beam"):
            drape.sew(flaps, beam, cell=0.02, folder=tmp_path / "free", **how)
    with pytest.raises(drape.SceneError, match="free: no garment was sewn in this"):
        drape.Sewn(tmp_path / "free")


def test_patterns_and_bodies_are_swept(flaps: Path, tmp_path: Path) -> None:
    """Garments are sewn in workers; names of values are the table's, draws have
    their seed, and a second sweep finds all results."""
    scene = {
        "garments": [{"pattern": str(flaps), "cell": 0.04}],
        "obstacles": [],
        "frames": 20,
    }
    axes = {
        "garments.0.pattern": {"flaps": str(flaps)},
        "obstacles": {"thin": [rail()], "thick": [rail(radius=0.016)]},
    }
    grid = drape.grid(scene, axes)
    assert [each.label for each in grid] == [
        "pattern=flaps, obstacles=thin",
        "pattern=flaps, obstacles=thick",
    ]
    done = drape.sweep(grid, tmp_path / "out", sew=True)
    assert not done.failed, done.failed
    for row, each in zip(done.rows, grid, strict=True):
        assert row["parameter.garments.0.pattern"] == "flaps"
        assert row["parameter.obstacles"] == each.parameters["obstacles"]
        assert row["seams"] == 1 and row["sewn_clean"] and row["steps"] == 0
        assert row["sewn_steps"] == 20 and row["intersecting"] == row["sewn_pairs"] == 0
        sewn = drape.sew(each.scene, pictures=False)
        assert row["most_gap"] == sewn.seams[0].gap
        data = done.data(each.label)
        assert np.array_equal(data["positions"][: len(sewn.positions)], sewn.positions)
    again = drape.sweep(grid, tmp_path / "out", sew=True)
    assert again.reused == 2
    drawn = drape.sample(scene, {**axes, "dt": (0.01, 0.02)}, 3, seed=5)
    assert {each.parameters["obstacles"] for each in drawn} == {"thin", "thick"}
    assert [(each.parameters["seed"], each.parameters["draw"]) for each in drawn] == [
        (5, 0),
        (5, 1),
        (5, 2),
    ]
