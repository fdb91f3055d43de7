# SPDX-License-Identifier: Apache-2.0
"""Scenes: objects, mappings and files are the same, and mistakes are named."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import json
import re
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, SCENES

import drape
from drape import scene as scenes

# The file of the tool's reader that has the keys of each object.
TABLES = {
    drape.Scene: "scene.c",
    drape.Wind: "scene.c",
    drape.Camera: "scene.c",
    drape.Key: "motion.c",
    drape.Motion: "motion.c",
    drape.Start: "cloth.c",
    drape.Region: "cloth.c",
    drape.Pin: "cloth.c",
    drape.Panel: "panel.c",
    drape.Garment: "garments.c",
    drape.Attach: "attach.c",
    drape.Cloth: "cloth.c",
    drape.Look: "look.c",
    drape.Frames: "sequence.c",
    drape.Bend: "limb.c",
    drape.Obstacle: "obstacle.c",
}
ARRAYS = {*scenes.CLOTH_ARRAYS, *scenes.OBSTACLE_ARRAYS, "sequence"}


@pytest.mark.parametrize("kind", TABLES, ids=lambda kind: kind.__name__)
def test_the_fields_are_the_readers_keys(kind: Any) -> None:
    text = (ROOT / "app/scene" / TABLES[kind]).read_text()
    tables = re.findall(r"json_key \w+\[\] = \{(.*?)\{0\}", text, re.DOTALL)
    keys = [set(re.findall(r'[A-Z]+_KEY\("(\w+)"', table)) for table in tables]
    fields = {field.name for field in dataclasses.fields(kind)}
    assert fields in keys or fields - ARRAYS in keys


def test_fabrics_are_the_tools() -> None:
    fabrics = drape.materials()
    rows = drape.tool.call("materials").splitlines()[2:]
    listed = [row.split() for row in rows[: rows.index("")]]
    assert [row[0] for row in listed] == list(fabrics) and "denim" in fabrics
    for name, density, *_, friction in listed:
        material = fabrics[name].material
        assert fabrics[name].name == name and fabrics[name].what
        assert material.density == float(density)
        assert material.friction == float(friction)


def test_a_materials_fields_are_the_readers_keys() -> None:
    text = (ROOT / "app/scene/cloth.c").read_text()
    table = text[text.index('NESTED_KEY("name", 0, read_fabric)') :].split("{0}")[0]
    keys = {"name", "stretch", "limit", *re.findall(r"MATERIAL\((\w+),", table)}
    assert keys == {field.name for field in dataclasses.fields(drape.Material)}


def test_objects_mappings_and_files_are_the_same(tmp_path: Path) -> None:
    objects = drape.Scene(
        cloths=[
            drape.Cloth(
                particles=(9, 9),
                size=(0.5, 0.5),
                material=drape.Material(name="denim", bend=2e-5),
                start=drape.Start(at=np.array([0, 0.6, 0])),
                pins=[drape.Pin(edge="u0", motion="lift")],
                holes=[drape.Region(disc=[0.25, 0.25, 0.05])],
            )
        ],
        obstacles=[drape.Obstacle(shape="sphere", radius=np.float64(0.2), detail=16)],
        motions=[
            drape.Motion(
                name="lift",
                keys=[drape.Key(time=0), drape.Key(time=1, move=[0, 1, 0])],
            )
        ],
        wind=drape.Wind(velocity=[1, 0, 0]),
        dt=0.01,
    )
    mapping = scenes.as_dict(objects)
    text = scenes.read(objects).text
    (tmp_path / "a.json").write_text(text)
    digests = set()
    for each in (objects, mapping, tmp_path / "a.json", str(tmp_path / "a.json")):
        world = drape.World(each)
        world.step(5)
        digests.add(world.digest())
    assert len(digests) == 1
    assert drape.World(tmp_path / "a.json").name == "a"


@pytest.mark.parametrize("scene", ["tiny", "sphere", "flag", "twist"])
def test_scenes_of_the_tool(scene: str) -> None:
    tree = json.loads((SCENES / f"{scene}.json").read_text())
    from_file, from_tree = drape.World(SCENES / f"{scene}.json"), drape.World(tree)
    assert from_file.digest() == from_tree.digest()


WRONG = [
    ({}, r"scene: \$: cloths: expected at least one"),
    ({"cloth": []}, r'unknown key "cloth"; did you mean "cloths"'),
    ({"cloths": [{"particles": [1, 5]}]}, r"\$\.cloths\[0\]\.particles"),
    ({"cloths": [{"material": "denin"}]}, "denin"),
    (
        {"cloths": [{"size": [1, float("nan")]}]},
        r"scene: \$\.cloths\[0\]\.size\[1\]: the number is not finite",
    ),
    ({"dt": np.float32("inf")}, r"\$\.dt: the number is not finite"),
    ({("a", 1): 2}, "keys must be"),
    ({"cloths": [{"size": [1, 1j]}]}, "1j"),
    ({"cloths": 5}, r"\$\.cloths: expected a list"),
    (
        {"cloths": [{"positions": [[0, 0, 0]]}]},
        r"positions of 101 × 101 particles: 1 × 3",
    ),
    ({"cloths": [{}], "obstacles": [{"vertices": [[0, 0, 0]]}]}, "lack triangles"),
    ({"cloths": [{}], "obstacles": [{"triangles": [[0, 1, 2]]}]}, "one of vertices"),
    (
        {"cloths": [{}], "obstacles": [{"vertices": [], "triangles": [], "at": [0]}]},
        r"obstacles\[0\]: at: an obstacle of arrays",
    ),
    (
        {
            "cloths": [{}],
            "obstacles": [{"vertices": np.eye(3), "triangles": [[0.5] * 3]}],
        },
        "whole numbers",
    ),
    (
        {
            "cloths": [{"start": {"at": [5, 0, 0]}}],
            "obstacles": [{"vertices": np.eye(3), "triangles": [[0, 1, 3]]}],
        },
        r"\$\.obstacles\[0\]",
    ),
]


@pytest.mark.parametrize("scene, text", WRONG)
def test_mistakes_are_named(scene: Any, text: str) -> None:
    with pytest.raises(drape.SceneError, match=text):
        drape.World(scene)


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(drape.SceneError, match="No such file"):
        drape.World(tmp_path / "none.json")
    (tmp_path / "a.json").write_text('{"cloths": [{}],\n"dt" 1}')
    with pytest.raises(drape.SceneError, match=r"a\.json: line 2, column 6: "):
        drape.World(tmp_path / "a.json")
    (tmp_path / "a.json").write_text('{"dt": 1, "dt": 2, "cloths": [{}]}')
    for keys in ({}, {"threads": 1}):
        with pytest.raises(drape.SceneError, match=r"line 1, column 14: duplicate"):
            drape.World(tmp_path / "a.json", **keys)
    with pytest.raises(drape.SceneError, match=r"line 1, column 14: duplicate"):
        drape.grid(tmp_path / "a.json", {"frames": [1, 2]})
    with pytest.raises(drape.SceneError, match="expected a scene"):
        drape.World(3)  # type: ignore[arg-type]


def test_a_file_is_read_as_the_tool_reads_it(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    for code, text in (("utf-16", "UTF-16"), ("utf-16-le", "UTF-16")):
        file.write_bytes('{"cloths": [{}]}'.encode(code))
        for keys in ({}, {"threads": 1}):
            with pytest.raises(drape.SceneError, match=f"is in {text}"):
                drape.World(file, **keys)
    for data, text in (
        (b"PXR-USDC\0\xff", "is a USD file"),
        (b'{"name": "\xe9"}', "line 1, column 10: unable to decode byte 0xe9"),
        (b'{"dt": NaN}', "line 1, column 10: invalid token"),
        (b"[1]", "expected an object"),
    ):
        file.write_bytes(data)
        for keys in ({}, {"threads": 1}):
            with pytest.raises(drape.SceneError, match=text):
                drape.World(file, **keys)
    file.write_bytes(b'\xef\xbb\xbf{"cloths": [{"particles": [3, 3]}]}')
    world = drape.World(file, threads=1)
    world.add_obstacle({"shape": "box", "at": [0, -3, 0]})
    with pytest.raises(drape.SceneError, match=r"\$\.dt: the number is not finite"):
        drape.World(file, dt=float("nan"))
    assert (drape.World(file, gravity=np.array([0, 1, 0])).gravity == [0, 1, 0]).all()


def test_what_has_no_effect_on_a_world_is_told(sheet: dict[str, Any]) -> None:
    up = {"name": "up", "keys": [{"time": 0}, {"time": 1, "move": [0, 1, 0]}]}
    with pytest.warns(UserWarning, match=r"motions\[0\]: note: has no effect"):
        world = drape.World(sheet, motions=[up])
    with pytest.warns(UserWarning, match=r"\$\.block: note: has no effect"):
        drape.World(sheet, block=64)
    box = {"shape": "box", "at": [0, -3, 0]}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.add_obstacle({**box, "motion": "up"})
        world.set_material(0, {"friction": 0.1})
        world.add_obstacle({**box, "friction": 0.2})
        with pytest.raises(drape.SceneError, match="coordinate nan"):
            x = np.full((3, 3), np.nan)
            world.add_obstacle({"vertices": x, "triangles": [[0, 1, 2]]})
    with pytest.warns(UserWarning, match="friction: note: has no effect"):
        world.add_obstacle({**box, "friction": 0.05})
    x = np.array([[0, -9, 0], [3000, -9, 0], [0, -9, 3000]])
    with pytest.warns(UserWarning, match=r"note: the mesh is 3e\+03 m across"):
        world.add_obstacle({"vertices": x, "triangles": [[0, 1, 2]]})


def test_arrays_of_a_mesh_are_that_mesh() -> None:
    ball = {"shape": "sphere", "radius": 0.2, "detail": 16, "at": [0, -0.25, 0]}
    cloth = {"particles": [11, 11], "size": [0.5, 0.5]}
    shaped = drape.World({"cloths": [cloth], "obstacles": [ball]}, precision=64)
    body = shaped.bodies[1]
    x = np.asarray(shaped.positions)
    given = drape.World(
        {
            "cloths": [{**cloth, "positions": x[: body.vertices.start]}],
            "obstacles": [
                drape.Obstacle(
                    vertices=x[body.vertices],
                    triangles=shaped.triangles[body.triangles] - body.vertices.start,
                )
            ],
        },
        precision=64,
    )
    for world in (shaped, given):
        assert world.step(12).clean
        assert world.report and world.report.contacts > 0
    assert shaped.digest() == given.digest()


def test_velocities_and_frames() -> None:
    square = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
    frames = np.stack([square - [0, 1, 0], square - [0, 0.5, 0]])
    scene = drape.Scene(
        cloths=[
            drape.Cloth(particles=[3, 3], velocities=np.tile([0.0, 2.0, 0.0], (9, 1)))
        ],
        obstacles=[
            drape.Obstacle(
                triangles=[[0, 2, 1], [0, 3, 2]], vertex_frames=frames, frame_dt=0.1
            )
        ],
        gravity=[0, 0, 0],
        dt=0.05,
    )
    world = drape.World(scene, precision=64)
    assert (world.velocities[:9, 1] == 2).all()
    world.step()
    assert world.positions[9:, 1] == pytest.approx(np.full(4, -0.75))
    assert world.positions[:9, 1] == pytest.approx(np.full(9, 0.1))


SQUARE = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
HALVES = [[0, 2, 1], [0, 3, 2]]


def heights(
    body: drape.Obstacle, steps: int, folder: Path | None = None
) -> list[float]:
    """Where a level square of a scene is, step by step of 0.05 s."""
    cloth = drape.Cloth(particles=[3, 3], start=drape.Start(at=[0, 9, 0]))
    scene = drape.Scene(cloths=[cloth], obstacles=[body], dt=0.05, precision=64)
    world = drape.World(scene, folder=folder)
    found = []
    for _ in range(steps):
        assert np.ptp(world.positions[9:, 1]) == 0
        found.append(float(world.positions[9, 1]))
        world.step()
    return found


def test_frames_at_times_and_a_cubic() -> None:
    frames = np.stack([SQUARE - [0, -y, 0] for y in (0, 1, 2)])
    keys = {"triangles": HALVES, "vertex_frames": frames}
    even = drape.Obstacle(**keys, frame_times=np.array([0.05, 0.1, 0.2]))
    assert heights(even, 6) == pytest.approx([0, 0, 1, 1.5, 2, 2])
    same = drape.Obstacle(
        triangles=HALVES, sequence=frames, frame_times=[0.05, 0.1, 0.2]
    )
    assert heights(same, 6) == heights(even, 6)
    # the middle velocity is that from the first frame to the last, and at the end
    # the two add up to twice that of the way: spec/world/kinematics.md §4
    cubic = drape.Obstacle(**keys, frame_times=[0, 0.05, 0.15], between="cubic")
    m = 2 / 0.15
    at = 1 + 0.5 + 0.1 * (m - (20 - m)) / 8
    assert heights(cubic, 5) == pytest.approx([0, 1, at, 2, 2])


def test_sequences_of_files(tmp_path: Path) -> None:
    frames = np.stack([SQUARE - [0, -y, 0] for y in (0, 1, 3)])
    np.savez(tmp_path / "a.npz", frames=frames, faces=HALVES, frame_dt=0.05)
    drape.Scene(
        cloths=[drape.Cloth()],
        obstacles=[drape.Obstacle(vertices=SQUARE, triangles=HALVES)],
    ).save(tmp_path / "s.json")
    head = b"POINTCACHE2\0" + np.array([1, 4], "<i4").tobytes()
    head += np.array([0, 1], "<f4").tobytes() + np.array([3], "<i4").tobytes()
    (tmp_path / "a.pc2").write_bytes(head + frames.astype("<f4").tobytes())
    mesh = drape.read_meshes(tmp_path / "a.npz")["a"]
    for body in (
        drape.Obstacle(sequence=tmp_path / "a.npz"),
        drape.Obstacle(sequence=mesh),
        drape.Obstacle(mesh="s.obstacle0.ply", sequence="a.pc2", frame_dt=0.05),
    ):
        assert heights(body, 4, tmp_path) == pytest.approx([0, 1, 3, 3])
    slow = drape.Obstacle(sequence=mesh, frame_times=[0, 0.1, 0.2])
    assert heights(slow, 4) == pytest.approx([0, 0.5, 1, 2])


def test_wrong_sequences_are_refused(tmp_path: Path) -> None:
    frames = np.stack([SQUARE, SQUARE + 1])
    np.savez(tmp_path / "still.npz", vertices=SQUARE, faces=HALVES)
    given = {"triangles": HALVES, "sequence": frames}
    nan = frames.copy()
    nan[1, 2, 0] = np.nan
    for keys, words in (
        ({**given, "frame_times": [0, 1, 2]}, "3 times of 2 frames"),
        ({**given, "frame_times": [1, 1]}, "frame_time 1 does not ascend"),
        ({**given, "frame_times": [0, 1], "frame_dt": 1}, "it has frame_times"),
        ({**given, "sequence": nan}, "frame 1 vertex 2 has coordinate nan"),
        ({**given, "sequence": frames[0]}, "4 × 3; expected n × n × 3"),
        ({**given, "between": "spline"}, 'between: .spline.: expected "linear"'),
        ({**given, "vertices": SQUARE}, "sequence: it has vertices, too"),
        ({"sequence": frames}, "its arrays lack triangles"),
        ({**given, "triangles": [[0, 1, 4]]}, "names vertex 4 of 4"),
        ({"sequence": "a.pc2"}, "expected the mesh that the point cache moves"),
        ({"sequence": tmp_path / "still.npz"}, "none of its meshes moves"),
        ({"sequence": "gone.npz"}, "there is no such file"),
        (
            {"sequence": tmp_path / "still.npz", "triangles": HALVES},
            "it has triangles, and so has triangles",
        ),
    ):
        with pytest.raises(drape.SceneError, match=words):
            drape.World({"cloths": [{}], "obstacles": [keys]})


def test_a_scene_is_saved(tmp_path: Path) -> None:
    sheet = drape.Cloth(particles=np.array([9, 9]), start=drape.Start(at=(0, 0.8, 0)))
    ball = drape.Obstacle(name="Kugel ä", shape="sphere", radius=0.3)
    scene = drape.Scene(name="saved", cloths=[sheet], obstacles=[ball], dt=0.01)
    scene.save(tmp_path / "a.json")
    ends = []
    for each in (scene, tmp_path / "a.json"):
        world = drape.World(each)
        world.step(20)
        ends.append((world.name, world.digest(), world.bodies))
    assert ends[0] == ends[1]
    assert [each.name for each in tmp_path.iterdir()] == ["a.json"]
    assert drape.Scene.load(tmp_path / "a.json") == scene
    with pytest.raises(drape.SceneError, match=r"b\.json: there is no folder .*none"):
        scene.save(tmp_path / "none/b.json")


def test_a_scene_is_saved_with_its_arrays(tmp_path: Path) -> None:
    u = np.linspace(0, 1, 9)
    x = np.array([[a, 0.5 + 0.01 * a * b, b] for b in u for a in u])
    floor = np.array([[-1, 0.1, -1], [2, 0.1, -1], [2, 0.1, 2], [-1, 0.1, 2]])
    tri = [[0, 2, 1], [0, 3, 2]]
    cloth = drape.Cloth(particles=[9, 9], positions=x, velocities=np.full_like(x, 0.3))
    still = drape.Obstacle(name="floor", vertices=floor, triangles=tri, friction=0.5)
    frames = np.stack([floor - [0, 1, 0], floor - [0, 0.9, 0]])
    swell = drape.Obstacle(
        vertex_frames=frames, triangles=tri, frame_times=[0, 0.1], between="cubic"
    )
    scene = drape.Scene(cloths=[cloth], obstacles=[still, swell], precision=64)
    (tmp_path / "in").mkdir()
    scene.save(tmp_path / "in/a.json")
    assert (tmp_path / "in/a.obstacle0.ply").exists()
    ends = []
    for each in (
        scene,
        tmp_path / "in/a.json",
        drape.Scene.load(tmp_path / "in/a.json"),
    ):
        world = drape.World(each, threads=2)
        world.step(20)
        ends.append(world.digest())
    assert ends[0] == ends[1] == ends[2]
    assert drape.World(tmp_path / "in/a.json", dt=0.01).dt == 0.01
    with pytest.raises(drape.SceneError, match='unknown key "positions"'):
        drape.tool.call("plan", tmp_path / "in/a.json")
    (tmp_path / "in/a.cloth0.positions.npy").write_text("none")
    with pytest.raises(
        drape.SceneError, match=r"a\.cloth0\.positions\.npy: expected an"
    ):
        drape.World(tmp_path / "in/a.json")
    with pytest.raises(drape.SceneError, match=r"obstacles\[0\]: its arrays lack tri"):
        drape.Scene(obstacles=[drape.Obstacle(vertices=floor)]).save(
            tmp_path / "b.json"
        )


@pytest.mark.parametrize("name", drape.examples.names())
def test_every_example_is_loaded(name: str) -> None:
    try:
        scene = drape.Scene.load(drape.examples.path(name))
    except drape.SceneError as error:
        assert "found neither" in str(error)  # a statue that is not here
        return
    assert isinstance(scene.cloths, list) and isinstance(scene.cloths[0], drape.Cloth)
    assert "drape.Scene(" in repr(scene)


def test_a_file_that_is_loaded_is_checked(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    for text, words in (
        ('{"cloths": [{"particles": [1, 1]}]}', r"a\.json: \$\.cloths\[0\]\.part"),
        ('{"cloths": [{"pin": []}]}', 'unknown key "pin"; did you mean "pins"'),
        ('{"cloths": 3}', r"\$\.cloths: expected"),
        ("{", "line 1"),
    ):
        file.write_text(text)
        with pytest.raises(drape.SceneError, match=words):
            drape.Scene.load(file)


def test_paths_begin_in_the_folder(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    (tmp_path / "models/a.off").write_text(
        "OFF\n3 1 0\n0 -1 0\n1 -1 0\n0 -1 1\n3 0 1 2\n"
    )
    scene = {"cloths": [{}], "obstacles": [{"mesh": "models/a.off"}]}
    assert len(drape.World(scene, folder=tmp_path).triangles) == 20001
    with pytest.raises(drape.SceneError, match="found neither"):
        drape.World(scene)


def test_other_formats_are_read_too(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nf 1 2 3\n")
    scene = {"cloths": [{}], "obstacles": [{"mesh": "a.obj"}]}
    assert len(drape.World(scene, folder=tmp_path).triangles) == 20001
    (tmp_path / "a.obj").write_text("v 0 -1 0\n")
    with pytest.raises(drape.SceneError, match=r"a\.obj"):
        drape.World(scene, folder=tmp_path)


def test_notes_are_warnings_at_the_callers_line(tmp_path: Path) -> None:
    (tmp_path / "a.off").write_text("OFF\n3 1 0\n0 -1 0\n1 -1 0\n2 -1 0\n3 0 1 2\n")
    scene = {"cloths": [{}], "obstacles": [{"mesh": "a.off"}]}
    with pytest.warns(UserWarning, match="1 triangles without area") as warned:
        drape.World(scene, folder=tmp_path)
    assert [warning.filename for warning in warned] == [__file__]


def test_keys_are_given_by_their_names() -> None:
    with pytest.raises(TypeError, match=r"Cloth\(51, 51\): .*particles=\[51, 51\]"):
        drape.Cloth(51, 51)
    with pytest.raises(TypeError, match=r"Obstacle\(.*\): .*mesh="):
        drape.Obstacle(np.zeros((3, 3)))
    for kind in (drape.Scene, drape.Material, drape.Start, drape.Pin, drape.Key):
        with pytest.raises(TypeError, match="keys are given by their names"):
            kind(1)
    for kind, key, text in (
        (drape.Cloth, "colour", '"colour"; did you mean "colour" in "look"'),
        (drape.Cloth, "mass", '"mass"; did you mean "density" in "material"'),
        (drape.Cloth, "mesh", "cannot simulate a mesh of triangles as cloth yet"),
        (drape.Obstacle, "file", '"file"; did you mean "mesh"'),
        (drape.Material, "weight", '"weight"; did you mean "density"'),
        (drape.Pin, "egde", '"egde"; did you mean "edge"'),
        (drape.Scene, "device", "cannot choose a device by its number yet"),
    ):
        with pytest.raises(TypeError, match=rf"drape\.{kind.__name__}: .*{text}"):
            kind(**{key: 1})


def test_scenes_are_compared() -> None:
    def scene(**keys: Any) -> drape.Scene:
        x = np.arange(12.0).reshape(4, 3)
        cloth = drape.Cloth(**{"particles": [2, 2], "positions": x, **keys})
        ball = drape.Obstacle(shape="sphere", at=np.array([0, 1, 0]))
        return drape.Scene(cloths=[cloth], obstacles=[ball], dt=0.01)

    assert scene() == scene()
    assert scene(particles=(2, 2)) == scene(particles=np.array([2, 2]))
    assert scene(material={"name": "denim"}) == scene(material={"name": "denim"})
    for keys in (
        {"particles": [2, 3]},
        {"positions": np.arange(9.0).reshape(3, 3)},
        {"positions": None},
        {"positions": [[0, 1], [2]]},
        {"material": {"name": "denim"}},
    ):
        assert scene() != scene(**keys)
    assert scene() != drape.Cloth() and drape.Cloth() != drape.Region()
    assert copy.deepcopy(scene()) == scene()


VERTICES = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1], [0, -1, 0]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def meshes() -> dict[str, Any]:
    """A tetrahedron as each package that is installed here has it."""
    found: dict[str, Any] = {
        "pair": (VERTICES, TRIANGLES),
        "lists": [VERTICES.tolist(), TRIANGLES.tolist()],
        "vertices and triangles": SimpleNamespace(
            vertices=VERTICES, triangles=TRIANGLES
        ),
        "cells": SimpleNamespace(points=VERTICES, cells_dict={"triangle": TRIANGLES}),
    }
    with contextlib.suppress(ImportError):
        import trimesh

        found["trimesh"] = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
        found["trimesh.Scene"] = trimesh.Scene(found["trimesh"])
    with contextlib.suppress(ImportError):
        import pyvista

        flat = np.insert(TRIANGLES, 0, 3, axis=1).ravel()
        found["pyvista"] = pyvista.PolyData(VERTICES, flat)
    return found


@pytest.mark.parametrize("kind", meshes())
def test_meshes_are_taken_as_they_are(kind: str) -> None:
    cloth = {"particles": [3, 3], "start": {"at": [0, 1, 0]}}
    mesh = meshes()[kind]
    for scene in (
        drape.Scene(
            cloths=[drape.Cloth(**cloth)], obstacles=[drape.Obstacle(mesh=mesh)]
        ),
        {"cloths": [cloth], "obstacles": [{"mesh": mesh}]},
    ):
        world = drape.World(scene)
        body = world.bodies[1]
        x = world.positions[body.vertices]
        # a package may number the vertices and begin the triangles otherwise
        got = {
            tuple(map(tuple, np.sort(x[t], 0)))
            for t in world.triangles[body.triangles] - 9
        }
        assert got == {tuple(map(tuple, np.sort(VERTICES[t], 0))) for t in TRIANGLES}
    assert drape.audit(mesh).count == 0


def test_what_is_no_mesh() -> None:
    cloth = {"particles": [3, 3], "start": {"at": [0, 1, 0]}}

    def make(**keys: Any) -> None:
        drape.World({"cloths": [cloth], "obstacles": [keys]})

    with pytest.raises(drape.SceneError, match=r"obstacles\[0\]\.mesh: 5 is no mesh"):
        make(mesh=5)
    with pytest.raises(drape.SceneError, match=r"is no mesh; .* trimesh, pyvista"):
        make(mesh=VERTICES)
    with pytest.raises(drape.SceneError, match="it has vertices, and so has vertices"):
        make(mesh=(VERTICES, TRIANGLES), vertices=VERTICES)
    with pytest.raises(drape.SceneError, match="scale: an obstacle of arrays"):
        make(mesh=(VERTICES, TRIANGLES), scale=2)
    with pytest.raises(drape.SceneError, match="vertices: 4 × 2; expected n × 3"):
        make(mesh=(VERTICES[:, :2], TRIANGLES))


def test_what_would_have_no_effect_is_refused(tiny: Path, tmp_path: Path) -> None:
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1]])
    cloth = {"particles": [2, 2], "positions": x}
    for keys, words in (
        ({"start": {"at": [0, 1, 0]}}, "start: it has positions"),
        ({"velocities": x, "velocity": [0, 0, 0]}, "velocity: it has velocities"),
    ):
        with pytest.raises(drape.SceneError, match=rf"cloths\[0\]: {words}, .*effect"):
            drape.World({"cloths": [{**cloth, **keys}]})
    with pytest.raises(drape.SceneError, match=r"positions of 3 × 2 particles: 4 × 3"):
        drape.World({"cloths": [{**cloth, "particles": [3, 2]}]})
    still = {"vertices": x - 1, "triangles": [[0, 1, 2]], "frame_dt": 0.1}
    with pytest.raises(drape.SceneError, match="frame_dt: it has no vertex_frames"):
        drape.World({"cloths": [cloth], "obstacles": [still]})
    with pytest.raises(drape.SceneError, match=f"folder: {tmp_path}: .* own folder"):
        drape.World(tiny, folder=tmp_path)
