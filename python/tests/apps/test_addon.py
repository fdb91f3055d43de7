# SPDX-License-Identifier: Apache-2.0
"""The Blender add-on: it marks, bakes and scrubs, in Blender without a window."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

import drape
from apps.addon import FRAMES, addon, ball, refused, sheet, shown, triangles
from apps.runs import ROOT, tool

__all__ = ["addon"]

bpy = need("bpy")


def test_every_fabric_is_offered(addon: Any) -> None:
    names = [item[0] for item in addon.fabric_items(None, None)]
    listed = subprocess.run([tool(), "materials"], capture_output=True, text=True)
    rows = listed.stdout.split("\n\n")[0].splitlines()[2:]
    assert names == [row.split()[0] for row in rows] and len(names) >= 14
    assert all(item[2] for item in addon.fabric_items(None, None))


def test_the_pack_names_its_wheels(tmp_path: Path) -> None:
    wheel, out = tmp_path / "some-1-py3-none-any.whl", tmp_path / "out.zip"
    wheel.write_text("a wheel")
    pack = ROOT / "app/blender/pack.py"
    subprocess.run([sys.executable, pack, out, wheel], check=True)
    with zipfile.ZipFile(out) as archive:
        manifest = archive.read("blender_manifest.toml").decode()
        names = archive.namelist()
    assert 'wheels = [\n    "./wheels/some-1-py3-none-any.whl",\n]' in manifest
    assert manifest.index("wheels") < manifest.index("[permissions]")
    modules = {p.name for p in pack.parent.glob("*.py")} - {"pack.py"}
    assert {*modules, "fabrics.def", "wheels/some-1-py3-none-any.whl"} < set(names)
    version = (ROOT / "spec/drape.h").read_text().split('DRAPE_VERSION "')[1]
    assert f'version = "{version.split(chr(34))[0]}"' in manifest


def packed(out: Path, *names: str) -> subprocess.CompletedProcess[str]:
    """Packs wheels of these names, which are made."""
    for name in names:
        out.with_name(name).write_text("a wheel")
    wheels = [out.with_name(name) for name in names]
    pack = ROOT / "app/blender/pack.py"
    return subprocess.run(
        [sys.executable, pack, out, *wheels], capture_output=True, text=True
    )


def test_the_pack_names_its_platforms(tmp_path: Path) -> None:
    both = "a-1-cp310-abi3-manylinux2014_x86_64.manylinux_2_17_x86_64.whl"
    done = packed(tmp_path / "x.zip", both, "p-1-py3-none-any.whl")
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "x.zip") as archive:
        manifest = archive.read("blender_manifest.toml").decode()
    assert 'platforms = ["linux-x64"]\nwheels' in manifest
    done = packed(tmp_path / "y.zip", both, "b-1-cp311-cp311-macosx_11_0_arm64.whl")
    assert done.returncode == 1 and not (tmp_path / "y.zip").exists()
    assert "b is for macos-arm64; a for linux-x64: expected wheels" in done.stderr
    done = packed(tmp_path / "z.zip", "c-1-cp311-cp311-plan9_mips.whl")
    assert done.returncode == 1 and "knows no platform plan9_mips" in done.stderr


INSTALLED = """
import sys
import bpy
bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=True)
root = bpy.utils.user_resource("EXTENSIONS")
sys.path.insert(0, root + "/.local/lib/python3.11/site-packages")
import drape
assert drape.__file__.startswith(root), drape.__file__
bpy.ops.mesh.primitive_grid_add(size=0.5, x_subdivisions=9, y_subdivisions=9)
bpy.context.object.drape.role = "CLOTH"
bpy.context.scene.frame_end = 5
assert bpy.ops.drape.bake() == {"FINISHED"}
"""


def test_blender_installs_the_pack(tmp_path: Path) -> None:
    wheels = sorted((ROOT / "dist").glob("drape_cloth-*.whl"))
    if not wheels:
        pytest.skip("there is no wheel in dist: make wheel")
    out = tmp_path / "drape.zip"
    pack = ROOT / "app/blender/pack.py"
    subprocess.run([sys.executable, pack, out, wheels[-1]], check=True)
    done = subprocess.run(
        [sys.executable, "-c", INSTALLED, out],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Info: drape: 5 frames, 12 steps, 0 not clean" in done.stdout


def test_a_baked_cloth_falls_upright_and_apart(addon: Any) -> None:
    cloth, body = sheet(), ball(moving=True)
    start = shown(cloth, 5)
    assert bpy.ops.drape.bake() == {"FINISHED"}
    assert cloth.drape.baked == FRAMES + 1
    assert np.allclose(shown(cloth, 5), start, atol=1e-6)
    end = shown(cloth, 5 + FRAMES)
    # corners fall along -z as far as gravity takes them; the ball holds the middle
    fallen = start[:, 2] - end[:, 2]
    assert 0.2 < fallen.max() < 9.81 * 0.4**2 / 2 + 0.01
    assert fallen.min() < 0.05
    # no frame intersects, by the exact count
    for frame in (5, 9, 5 + FRAMES):
        x, y = shown(cloth, frame), shown(body, frame)
        tri = np.concatenate([triangles(cloth), triangles(body) + len(x)])
        group = np.repeat([1, 0], [len(triangles(cloth)), len(triangles(body))])
        both = np.concatenate([x, y])
        assert drape.audit(both, tri, group.astype(np.int32)).count == 0


def test_gravity_is_the_scenes(addon: Any) -> None:
    cloth, scene = sheet(), bpy.context.scene
    start = shown(cloth, 5)
    scene.gravity = (1.5, 0, -3)
    bpy.ops.drape.bake()
    way = (shown(cloth, 5 + FRAMES) - start).mean(0)
    due = np.array(scene.gravity) * 0.4**2 / 2  # a step more or less: 24 are 0.4 s
    assert np.abs(way - due).max() < 0.05 * np.linalg.norm(due)
    scene.use_gravity = False
    bpy.ops.drape.bake()
    assert np.abs(shown(cloth, 5 + FRAMES) - start).max() < 1e-5


def test_frames_are_those_of_the_world(addon: Any, tmp_path: Path) -> None:
    cloth = sheet()
    ball()
    scene = bpy.context.scene
    scene.drape.steps = 3
    assert bpy.ops.drape.bake() == {"FINISHED"}
    definition, [made], _ = addon.bake.prepare(scene, tmp_path)
    world = drape.World(definition)
    assert world.steps_per_frame == 3 and abs(world.dt - 1 / 90) < 1e-15
    for frame in range(FRAMES + 1):
        x = np.asarray(world.positions[world.bodies[0].vertices], np.float64)
        rows = made.made.rows.ravel()
        got = shown(cloth, 5 + frame)[rows]
        assert np.allclose(got, addon.cloth.to_blender(x), atol=1e-6), frame
        world.step(3)


def test_a_bake_again_gives_the_same_file(addon: Any) -> None:
    cloth = sheet()
    bpy.ops.drape.bake()
    path = addon.bake.cache_path(cloth)
    first = path.read_bytes()
    bpy.context.scene.frame_set(9)
    bpy.ops.drape.bake()
    assert path.read_bytes() == first
    assert [m.name for m in cloth.modifiers] == ["drape"]
    bpy.ops.drape.free()
    assert not path.exists() and not cloth.modifiers


def test_pins_hold(addon: Any) -> None:
    cloth = sheet()
    group = cloth.vertex_groups.new(name="held")
    group.add([0, 12], 1.0, "REPLACE")
    cloth.drape.pins = "held"
    start = shown(cloth, 5)
    bpy.ops.drape.bake()
    moved = np.linalg.norm(shown(cloth, 5 + FRAMES) - start, axis=1)
    assert moved[[0, 12]].max() < 1e-6 and moved[100] > 0.1


def test_the_cache_is_beside_the_saved_file(addon: Any, tmp_path: Path) -> None:
    cloth = sheet("a/b")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.drape.bake()
    [file] = tmp_path.glob("scene_a_b_*.pc2")
    assert cloth.modifiers["drape"].filepath == f"//{file.name}"
    end = shown(cloth, 5 + FRAMES)
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert np.array_equal(shown(bpy.data.objects["a/b"], 5 + FRAMES), end)
    assert not list(tmp_path.glob("*.part"))


def test_a_bake_that_is_ended_leaves_what_was_there(addon: Any) -> None:
    cloth = sheet()
    bpy.ops.drape.bake()
    path = addon.bake.cache_path(cloth)
    before = path.read_bytes()
    work = addon.bake.bake(bpy.context.scene)
    next(work)
    work.close()
    assert path.read_bytes() == before
    assert not list(path.parent.glob("*.part"))


def test_faults_name_the_object(addon: Any) -> None:
    refused("no object of the scene is a cloth")
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.drape.role = "CLOTH"
    refused("Sphere: it is no grid of quads, expected")
    bpy.context.object.drape.role = "NONE"
    cloth = sheet()
    body = ball()
    body.location.z = 0.3
    refused("intersecting")  # the cloth starts within the ball
    assert not cloth.modifiers
    body.location.z = -1
    body.data.clear_geometry()
    refused("ball: a body without faces")


def test_grids_are_found_in_any_order(addon: Any) -> None:
    grid = addon.cloth.grid
    rng = np.random.default_rng(7)
    for m, n in ((2, 2), (2, 5), (6, 2), (7, 4)):
        number = np.arange(m * n).reshape(n, m)
        corners = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
        quads = np.stack(corners, -1).reshape(-1, 4)
        plain = grid.order([tuple(q) for q in quads.tolist()], m * n)
        assert np.array_equal(plain, number)
        other = rng.permutation(m * n)
        mixed = [tuple(np.roll(other[q], k).tolist()) for k, q in enumerate(quads)]
        found = grid.order([mixed[k] for k in rng.permutation(len(mixed))], m * n)
        place = np.argsort(other)[found]
        steps = np.abs(np.diff(place, axis=1)), np.abs(np.diff(place, axis=0))
        assert {*steps[0].ravel(), *steps[1].ravel()} <= {1, m}
        assert found.size == m * n
        with pytest.raises(grid.NoGrid):
            grid.order([tuple(q) for q in quads[1:].tolist()], m * n)
        with pytest.raises(grid.NoGrid):
            grid.order([tuple(q[:3]) for q in quads.tolist()], m * n)
