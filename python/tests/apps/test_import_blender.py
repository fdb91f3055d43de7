# SPDX-License-Identifier: Apache-2.0
"""Blender imports what is exported: upright, aligned, at the right rate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

from drape.export import Body, Run
from drape.export.cli import export

bpy = need("bpy")


def upright(x: np.ndarray) -> np.ndarray:
    """A run's positions where Blender should have them: +y is its +z."""
    return np.stack([x[:, 0], -x[:, 2], x[:, 1]], 1)


def bring(file: Path) -> Any:
    """Imports a file into an empty scene at 60 frames a second."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 60
    if file.suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(file), merge_vertices=False)
    elif file.suffix == ".abc":
        bpy.ops.wm.alembic_import(filepath=str(file), as_background_job=False)
    else:
        bpy.ops.wm.usd_import(filepath=str(file))
    return scene


def shown(scene: Any, frame: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """The vertices, in the world, and the corners of all meshes at a frame."""
    scene.frame_set(int(frame), subframe=frame % 1)
    graph = bpy.context.evaluated_depsgraph_get()
    found = []
    for thing in scene.objects:
        if thing.type != "MESH":
            continue
        thing = thing.evaluated_get(graph)
        mesh = thing.to_mesh()
        x = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", x)
        corner = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", corner)
        pose = np.array(thing.matrix_world)
        world = x.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
        found.append((world, corner))
        thing.to_mesh_clear()
    return found


def close(run: Run, body: Body, frame: int, meshes: list[Any]) -> bool:
    """Whether one of the meshes is the body, triangle by triangle."""
    expected = upright(run.positions(body, frame))[body.faces.ravel()]
    return any(
        len(corner) == len(expected) and np.allclose(world[corner], expected, atol=1e-5)
        for world, corner in meshes
    )


@pytest.mark.parametrize("ending", [".usdc", ".glb", ".abc"])
@pytest.mark.parametrize("name", ["still", "pushed"])
def test_upright_aligned_and_in_time(
    name: str, ending: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    if ending == ".usdc":
        need("pxr")
    if ending == ".glb":
        need("pygltflib")
    run, file = Run(request.getfixturevalue(name)), tmp_path / f"run{ending}"
    export(run, file)
    scene = bring(file)
    assert len([o for o in scene.objects if o.type == "MESH"]) == len(run.bodies)
    for frame in run.frames():
        # Blender's USD importer takes a time code for a frame, at any rate; the
        # others go by seconds
        at = frame if ending == ".usdc" else frame * run.seconds * 60
        meshes = shown(scene, at)
        for body in run.bodies:
            assert close(run, body, frame, meshes), (body.name, frame)


def test_alembic_keeps_every_bit(pushed: Path, tmp_path: Path) -> None:
    run, file = Run(pushed), tmp_path / "run.abc"
    export(run, file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 12  # every second frame of 24 a second
    bpy.ops.wm.alembic_import(filepath=str(file), as_background_job=False)
    for k, frame in enumerate(run.frames()):
        bpy.context.scene.frame_set(k)
        graph = bpy.context.evaluated_depsgraph_get()
        names = "sheet_é", "sheet_é_001", "ball"
        for name, body in zip(names, run.bodies, strict=False):
            mesh = bpy.data.objects[name].evaluated_get(graph).data
            x = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", x)
            expected = upright(run.positions(body, frame))
            assert np.array_equal(x.reshape(-1, 3), expected), (name, frame)


def test_uvs_and_materials_arrive(still: Path, tmp_path: Path) -> None:
    run, file = Run(still), tmp_path / "run.abc"
    export(run, file)
    bring(file)
    body, thing = run.bodies[0], bpy.data.objects["sheet_é"]
    uv = np.empty(2 * len(thing.data.loops), np.float32)
    thing.data.uv_layers[0].uv.foreach_get("vector", uv)
    corner = np.empty(len(thing.data.loops), np.int32)
    thing.data.loops.foreach_get("vertex_index", corner)
    assert body.uv is not None
    assert np.array_equal(uv.reshape(-1, 2), body.uv[corner])
    assert thing.material_slots[0].name == "sheet_é"
