# SPDX-License-Identifier: Apache-2.0
"""Meshes with UV charts: charts are panels, shared vertices are seams, and the mesh
comes back."""

from __future__ import annotations

import json
import random
import sys
from pathlib import Path
from typing import Any

import charted
import charted_tee
import numpy as np
import pytest

import drape
from drape.sewing_cli import main

CELL = 0.02  # m


def parts(file: Path) -> tuple[np.ndarray[Any, Any], list[str], list[str]]:
    """The vertices of an OBJ, its faces without normals, and its other lines."""
    lines = file.read_text().splitlines()
    x = [line.split()[1:] for line in lines if line.startswith("v ")]
    corners = [line.split()[1:] for line in lines if line.startswith("f ")]
    faces = [" ".join("/".join(c.split("/")[:2]) for c in face) for face in corners]
    others = [line for line in lines if line.split()[0] not in ("v", "vn", "f")]
    return np.array(x, float), faces, others


def distance(points: Any, x: Any, tri: Any) -> float:
    """The largest distance of points from the triangles of a mesh."""
    most = 0.0
    p = np.asarray(x, float)[tri]
    d = np.roll(p, -1, axis=1) - p
    normal = np.cross(d[:, 0], d[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    for point in np.asarray(points, float):
        to = point - p
        side = (np.cross(d, to) * normal[:, None]).sum(2)
        t = np.clip((to * d).sum(2) / (d * d).sum(2), 0, 1)
        edge = np.linalg.norm(to - t[:, :, None] * d, axis=2).min(1)
        plane = np.abs((to[:, 0] * normal).sum(1))
        far = np.where((side >= 0).all(1), plane, edge)
        most = max(most, float(far.min()))
    return most


def surface(sewn: drape.Sewn, frame: int) -> tuple[Any, Any]:
    """All cloths of a frame as one mesh."""
    cloths = [each for each in sewn.run.bodies if each.kind == "cloth"]
    x = [sewn.run.positions(each, frame) for each in cloths]
    first = np.cumsum([0, *map(len, x)])
    tri = [each.faces + first[k] for k, each in enumerate(cloths)]
    return np.concatenate(x), np.concatenate(tri)


def gaps(mesh: drape.UVMesh, folder: Path, cell: float) -> list[float]:
    """The largest gap of each seam where the mesh starts, m."""
    scene = drape.Scene(garments=[mesh.garment(folder, cell=cell)])
    world = drape.World(scene, allow_intersecting=True)
    seams = len(mesh.pattern(cell)["pattern"]["stitches"])
    return [float(np.linalg.norm(world.seam(k)[0], axis=1).max()) for k in range(seams)]


def test_a_skirt_comes_back(tmp_path: Path) -> None:
    """A tube of two charts, worn: it has the file's faces and UVs in all frames, on the
    cloth."""
    file = charted.tube().write(tmp_path / "skirt.obj", normals=True)
    ball = drape.Obstacle(shape="sphere", radius=0.145, at=[0, 0.8, 0], friction=1)
    mesh = drape.UVMesh(file)
    assert [each.name for each in mesh.charts] == ["left", "right"]
    assert all(each.strain < 1e-6 and each.scale == 1 for each in mesh.charts)
    pattern = mesh.pattern(CELL)["pattern"]
    assert [len(each["edges"]) for each in pattern["panels"].values()] == [4, 4]
    assert [len(each) for each in pattern["stitches"]] == [2, 2]
    sewn = drape.sew(file, ball, cell=CELL, frames=12, pictures=False, material="denim")
    assert sewn.clean and not sewn.open and sewn.stages["worn"] <= 1
    assert sewn.seams[0].name.startswith("left ")
    # at the start the cloth is the mesh
    assert np.abs(sewn.vertices(0) - mesh.vertices).max() < 0.002
    assert sewn.save_mesh(tmp_path / "end.obj") == 1
    assert sewn.save_mesh(tmp_path / "worn_%03d.obj") == 13
    x, faces, others = parts(tmp_path / "end.obj")
    was = parts(file)
    assert faces == was[1] and others == was[2] and x.shape == was[0].shape
    for frame in (0, 6, 12):
        x, faces, others = parts(tmp_path / f"worn_{frame:03d}.obj")
        assert faces == was[1] and others == was[2]
        assert distance(x, *surface(sewn, frame)) < 1e-3 * CELL
    assert np.array_equal(x, parts(tmp_path / "end.obj")[0])
    # a folder that is read anew knows its mesh
    again = drape.Sewn(sewn.folder)
    assert np.array_equal(again.vertices(6), sewn.vertices(6))
    assert again.meshes[0] and again.meshes[0].file == file.resolve()
    with pytest.raises(drape.SceneError, match="garment 1 is of no mesh"):
        sewn.save_mesh(tmp_path / "more.obj", garment=1)
    with pytest.raises(
        drape.SceneError, match=r"a place for its number, as frame_%04d"
    ):
        sewn.save_mesh(tmp_path / "50%.obj")
    # and a world takes the garment
    garment = mesh.garment(tmp_path, cell=CELL, material="denim", name="skirt")
    world = drape.World(drape.Scene(garments=[garment], obstacles=[ball]))
    assert [each.name for each in world.bodies][:2] == ["skirt.left", "skirt.right"]
    assert world.step(3).clean
    assert world.seams == 2
    count = world.bodies[1].vertices.stop
    heights = mesh.sampled(mesh.vertices[:, 1:2], CELL)[:, 0]
    there = ~np.isnan(heights)
    assert heights.shape == (count,) and 0.9 < there.mean() <= 1
    assert np.array_equal(heights[there], mesh.start(CELL)[there, 1])
    with pytest.raises(drape.SceneError, match="values: 1 × 2; expected"):
        mesh.sampled([[1, 2]], CELL)
    mesh.save(tmp_path / "now.obj", mesh.carried(world.positions[:count], CELL))
    assert parts(tmp_path / "now.obj")[1] == was[1]


def test_a_t_shirt(tmp_path: Path) -> None:
    """Four panels and ten seams of a pattern are found again in its mesh, which is
    worn by a thinner body, as cells cut its corners."""
    file = charted_tee.tee(tmp_path / "flat").write(tmp_path / "tee.obj")
    mesh = drape.UVMesh(file, strain=0.2)  # by folds that the coarse cloth has
    pattern = mesh.pattern(0.04)["pattern"]
    drawn = json.loads(charted_tee.PATTERN.read_text())["pattern"]

    def seams(found: Any) -> list[list[str]]:
        return sorted(sorted(side["panel"] for side in each[:2]) for each in found)

    assert seams(pattern["stitches"]) == seams(drawn["stitches"])
    for name, panel in pattern["panels"].items():
        assert len(panel["edges"]) == len(drawn["panels"][name]["edges"])
        size = np.ptp(panel["vertices"], axis=0) * 100
        want = np.ptp(drawn["panels"][name]["vertices"], axis=0)
        assert size == pytest.approx(want, rel=0.05), name
    sewn = drape.sew(mesh, charted_tee.body(0.01), cell=0.04, frames=20, pictures=False)
    assert sewn.clean and not sewn.open and sewn.stages["worn"] < 10
    assert sewn.save_mesh(tmp_path / "worn.obj") == 1
    x, faces, others = parts(tmp_path / "worn.obj")
    was = parts(file)
    assert faces == was[1] and others == was[2] and np.abs(x - was[0]).max() > 0.01
    assert distance(x, *surface(sewn, 20)) < 0.1 * 0.04
    # the cloth begins where the mesh is, but for what its cells cut off
    assert abs(sewn.vertices(0) - mesh.vertices).max() < 0.01


def test_normals_are_those_of_the_new_shape(tmp_path: Path) -> None:
    file = charted.tube(n=8).write(tmp_path / "tube.obj", normals=True)
    mesh = drape.UVMesh(file)
    x = mesh.vertices @ np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    mesh.save(tmp_path / "turned.obj", x)
    lines = (tmp_path / "turned.obj").read_text().splitlines()
    normal = np.array([line.split()[1:] for line in lines if line[:3] == "vn "], float)
    for line in lines:
        for corner in line.split()[1:] if line.startswith("f ") else []:
            v, _, n = (int(each) - 1 for each in corner.split("/"))
            out = x[v] * [1, 0, 1] / 0.16
            assert np.abs(normal[n] - out).max() < 1e-6


def test_units(tmp_path: Path) -> None:
    """A file in millimetres, with UVs in thirds of a metre."""
    metres = drape.UVMesh(charted.tube(n=6).write(tmp_path / "m.obj"))
    made = charted.tube(n=6)
    made.uv = (np.array(made.uv) * 3).tolist()
    file = made.write(tmp_path / "mm.obj", unit=0.001)
    mesh = drape.UVMesh(file, unit=0.001)
    assert np.allclose(mesh.vertices, metres.vertices, atol=1e-9)
    assert np.allclose([each.scale for each in mesh.charts], 1 / 3, rtol=1e-5)
    assert np.allclose(mesh.start(CELL), metres.start(CELL), atol=1e-5)
    mesh.save(tmp_path / "same.obj", mesh.vertices)
    assert np.allclose(parts(tmp_path / "same.obj")[0], parts(file)[0], rtol=1e-8)
    with pytest.raises(drape.SceneError, match=r"chart left: is 497 m .* unit 1 right"):
        drape.UVMesh(file)
    # a scale that is given makes what is smaller a strain
    with pytest.raises(drape.SceneError, match=r"left: is strained by 100 % against"):
        drape.UVMesh(file, unit=0.001, scale=1 / 6)


def test_a_dart(tmp_path: Path) -> None:
    """A cone is a disc with a dart: one panel, sewn to itself up to its tip."""
    mesh = drape.UVMesh(charted.cone().write(tmp_path / "hat.obj"))
    pattern = mesh.pattern(CELL)["pattern"]
    (stitch,) = pattern["stitches"]
    assert [side["panel"] for side in stitch] == ["hat", "hat"] and len(stitch) == 2
    ball = drape.Obstacle(shape="sphere", radius=0.1, at=[0, 0.4, 0], friction=1)
    sewn = drape.sew(mesh, ball, cell=CELL, frames=12, pictures=False)
    (seam,) = sewn.seams
    assert seam.stage == "seams" and seam.closed and sewn.clean
    # a vertex on a curved rim may lie a little beyond the cells
    assert distance(sewn.vertices(), *surface(sewn, 12)) < 0.1 * CELL


@pytest.mark.parametrize("turned", [False, True])
def test_a_seam_all_around(tmp_path: Path, turned: bool) -> None:
    """Two discs: a seam without an end is cut in two; where one disc shows its wrong
    side, the right side of one meets the wrong side of the other."""
    made = charted.cushion()
    if turned:
        charted.flipped(made, ["upper"])
    mesh = drape.UVMesh(made.write(tmp_path / "cushion.obj"))
    stitches = mesh.pattern(CELL)["pattern"]["stitches"]
    assert [stitch[2:] for stitch in stitches] == 2 * [
        ["right_wrong"] if turned else []
    ]
    assert max(gaps(mesh, tmp_path, CELL)) < 0.02 * CELL


def test_mirrored_and_stacked_charts(tmp_path: Path) -> None:
    """UVs may show a chart from its wrong side, and charts may lie on each other."""
    plain = charted.tube()
    flat = gaps(drape.UVMesh(plain.write(tmp_path / "a.obj")), tmp_path, CELL)
    half = len(plain.uv) // 2
    uv = np.array(plain.uv)
    uv[half:] -= [1, 0]  # the same place as the other chart
    plain.uv = uv.tolist()
    stacked = drape.UVMesh(plain.write(tmp_path / "b.obj"))
    assert gaps(stacked, tmp_path, CELL) == pytest.approx(flat, abs=1e-6)
    uv[half:, 0] *= -1
    plain.uv = uv.tolist()
    mirrored = drape.UVMesh(plain.write(tmp_path / "c.obj"))
    assert [each.mirrored for each in mirrored.charts] == [False, True]
    assert gaps(mirrored, tmp_path, CELL) == pytest.approx(flat, abs=1e-6)
    stitches = mirrored.pattern(CELL)["pattern"]["stitches"]
    assert all(len(stitch) == 2 for stitch in stitches)
    assert np.allclose(mirrored.start(CELL), stacked.start(CELL), atol=1e-5)


def test_vertices_of_their_own(tmp_path: Path) -> None:
    """A file that has each chart's vertices and UVs corner by corner, as some programs
    write them, is the same mesh."""
    made = charted.tube(n=6)
    alone = charted.Charted()
    for name, faces in made.charts.items():
        alone.charts[name] = []
        first: dict[int, int] = {}
        for face in faces:
            for v, _ in face:
                if v not in first:
                    first[v] = len(alone.x)
                    alone.x.append(made.x[v])
            alone.charts[name].append(
                [(first[v], len(alone.uv) + k) for k, (v, _) in enumerate(face)]
            )
            alone.uv += [made.uv[t] for _, t in face]
    one = drape.UVMesh(made.write(tmp_path / "one.obj"))
    two = drape.UVMesh(alone.write(tmp_path / "two.obj"))
    assert one.pattern()["pattern"] == two.pattern()["pattern"]
    assert np.array_equal(one.start(CELL), two.start(CELL))


def test_what_is_refused(tmp_path: Path) -> None:
    """Each by one line that names the chart or the face; nothing is written."""

    def refused(what: str, made: charted.Charted | str, **keys: Any) -> None:
        file = tmp_path / "bad.obj"
        if isinstance(made, str):
            file.write_text(made)
        else:
            made.write(file)
        before = sorted(tmp_path.rglob("*"))
        with pytest.raises(drape.SceneError, match=what) as caught:
            drape.sew(drape.UVMesh(file, **keys), folder=tmp_path / "out", frames=0)
        assert "\n" not in str(caught.value)
        assert str(caught.value).startswith(str(file))
        after = [each for each in sorted(tmp_path.rglob("*")) if each.is_file()]
        assert after == [each for each in before if each.is_file()]

    tube = charted.tube
    made = tube(n=6)
    made.x = (np.array(made.x) * [1, 1.15, 1]).tolist()
    refused(r"left: is strained by 7\.2\d % .*, face \d+ by 7\.2\d %; .* 5 %", made)
    assert drape.UVMesh(made.write(tmp_path / "ok.obj"), strain=0.2).charts
    bare = made.write(tmp_path / "bare.obj").read_text().replace("/", " # ")
    bare = "\n".join(line for line in bare.splitlines() if line[:2] != "f ")
    refused(r"bad\.obj: it has no UVs; .*unwrap it", bare + "\nf 1 2 3\nf 2 3 4\n")
    refused(r"face 2: it has no UVs, where", bare + "\nf 1/1 2/2 3/3\nf 2 3 4\n")
    refused(r"there is no face in it", bare)
    refused(
        r"line \d+: face 1: there is no v 900; the file has 132", bare + "\nf 1 2 900"
    )
    refused(r"line \d+: face 1: -900: there is no v -900", bare + "\nf 1 2 -900")
    refused(r"line \d+: face 1: 1/x: expected whole", bare + "\nf 1/x 2 3")
    refused(r"line \d+: face 1: expected at least 3", bare + "\nf 1 2")
    refused(r"line 1: expected v and 3 numbers", "v 1 nan 2\n")
    refused(r"line 1: expected vt and 2 numbers", "vt 1\n")
    # a hole, a fold, a face that is turned over, a chart that is closed
    made = tube(n=6)
    del made.charts["left"][14]
    refused(r"chart left: it has a hole, beside face \d+", made)
    made = tube(n=6)
    made.charts["left"][14].reverse()
    refused(r"face \d+: it passes its edge to face \d+ in the same direction", made)
    made = tube(n=6)
    made.charts["right"].append(made.charts["right"][-1][::-1])
    refused(r"an edge is of faces|passes its edge", made)
    made = tube(n=6)
    made.uv[made.charts["left"][0][0][1]] = made.uv[made.charts["left"][0][2][1]]
    refused(r"face 1: it has no area in UV", made)
    # a seam whose other side lacks a vertex
    made = tube(n=6)
    one, two = made.charts["left"][:2]
    (gone,) = (c for c in one if c in two and made.uv[c[1]][0] == 0)
    # the other one's corners come where the edge that both had was
    at, to = one.index(gone), two.index(gone)
    between = [two[(to + 1) % 4], two[(to + 2) % 4], two[(to + 3) % 4]]
    between = [each for each in between if each not in one]
    made.charts["left"][:2] = [one[:at] + between + one[at + 1 :]]
    refused(r"left: an edge of face 1 has no vertex where chart right has vertex", made)
    # three charts in one seam
    made = tube(n=6)
    more = tube(n=6)
    fin = more.charts["left"][:10]
    first_uv = len(made.uv)
    made.uv += more.uv
    number = {v: v for face in fin for v, _ in face}
    for v in sorted(number):
        if np.hypot(more.x[v][0] - 0.16, more.x[v][2]) > 1e-6:
            number[v] = len(made.x)
            made.x.append((np.array(more.x[v]) * [1, 1, -1]).tolist())
    made.charts["fin"] = [[(number[v], first_uv + t) for v, t in f] for f in fin]
    refused(r"is sewn to face \d+ of chart \w+ and to face \d+ of chart \w+", made)
    with pytest.raises(drape.SceneError, match=r"none\.obj: No such file"):
        drape.sew(tmp_path / "none.obj")
    mesh = drape.UVMesh(tube(n=6).write(tmp_path / "ok.obj"))
    with pytest.raises(
        drape.SceneError, match=r"7 particles; ok\.obj has \d+ by cells"
    ):
        mesh.carried(np.zeros((7, 3)), CELL)
    with pytest.raises(drape.SceneError, match=r"unit: 0: expected metres above 0"):
        drape.UVMesh(tmp_path / "ok.obj", unit=0)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`drape sew MESH.obj` is this, by the tool too."""
    file = charted.tube(n=6, rows=4).write(tmp_path / "skirt.obj", unit=0.001)
    words = ["--unit", "0.001", "--cell", "0.04", "--frames", "2", "--no-picture"]
    out = tmp_path / "out"
    programs = str(Path(sys.executable).parent)
    said = drape.tool.call("sew", file, *words, "--out", out, programs=programs)
    assert said.endswith(f"2 of 2 seams closed; 3 meshes in {out / 'mesh'}\n")
    x, faces, others = parts(out / "mesh/skirt_0002.obj")
    was = parts(file)
    assert faces == was[1] and others == was[2]
    assert np.abs(x - was[0]).max() < 20 and np.ptp(x[:, 1]) > 300  # mm
    assert main([str(file), *words, "--out", str(out)]) == 2
    assert "sew.json; give another --out, or --force" in capsys.readouterr().err
    assert main([str(file), *words, "--out", str(out), "--force", "--every", "2"]) == 0
    names = sorted(each.name for each in (out / "mesh").iterdir())
    assert names == ["skirt_0000.obj", "skirt_0002.obj"]
    assert main([str(file), "--out", str(out)]) == 2
    assert "chart left: is 497 m large" in capsys.readouterr().err


@pytest.mark.filterwarnings("error")
def test_damaged_files(tmp_path: Path) -> None:
    """Whatever a file says, it is a mesh or refused by one line that names it."""
    file = tmp_path / "damaged.obj"
    words = ["0", "-1", "1e300", "nan", "inf", "x", "/", "1/", "1//1", "5/5/1", "-3/-3"]
    meshes = charted.tube(4, 3), charted.cone(8, 3), charted.cushion(12, 3)
    texts = [each.write(file, normals=True).read_text() for each in meshes]
    taken = 0
    for seed in range(150):
        dice = random.Random(seed)
        lines = dice.choice(texts).splitlines()
        for _ in range(dice.choice([1, 1, 1, 2, 5])):
            k, other = dice.randrange(len(lines)), dice.randrange(len(lines))
            line = lines[k].split()
            change = dice.randrange(5)
            if change == 0:
                del lines[k]
            elif change == 1:
                lines.insert(other, lines[k])
            elif change == 2:
                lines[k], lines[other] = lines[other], lines[k]
            elif change == 3:
                line[dice.randrange(len(line))] = dice.choice(words)
                lines[k] = " ".join(line)
            else:
                lines[k] = " ".join(line[:1] + dice.sample(line[1:], len(line) - 1))
        file.write_text("\n".join(lines))
        try:
            mesh = drape.UVMesh(file, strain=dice.choice([0.05, 1e9]))
            mesh.save(tmp_path / "out.obj", mesh.carried(mesh.start(CELL), CELL))
            taken += 1
        except drape.SceneError as error:
            assert str(file) in str(error) and "\n" not in str(error)
    assert 10 < taken < 140
