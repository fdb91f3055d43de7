# SPDX-License-Identifier: Apache-2.0
"""The Blender add-on for its tests, and objects of a Blender scene."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from needs import need

from apps.runs import ROOT

bpy = need("bpy")
FRAMES = 12


def load() -> Any:
    """The add-on as a package of its own name."""
    folder = ROOT / "app/blender"
    for name in [name for name in sys.modules if name.startswith("drape_blender")]:
        del sys.modules[name]
    spec = importlib.util.spec_from_file_location(
        "drape_blender",
        folder / "__init__.py",
        submodule_search_locations=[str(folder)],
    )
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["drape_blender"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def addon() -> Iterator[Any]:
    """The add-on, in an empty scene of 13 frames at 30 a second."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    module = load()
    module.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 5, 5 + FRAMES, 30
    yield module
    module.unregister()


def sheet(name: str = "sheet", m: int = 13, n: int = 9) -> Any:
    """A cloth of 0.6 m × 0.4 m, turned, 0.32 m above the ground."""
    bpy.ops.mesh.primitive_grid_add(
        x_subdivisions=m - 1,
        y_subdivisions=n - 1,
        size=1,
        location=(0, 0, 0.32),
        rotation=(0, 0, 0.3),
    )
    thing = bpy.context.object
    thing.name, thing.scale = name, (0.6, 0.4, 1)
    thing.drape.role, thing.drape.fabric = "CLOTH", "cotton"
    return thing


def ball(moving: bool = False) -> Any:
    """A body of radius 0.15 m, which may move along x."""
    bpy.ops.mesh.primitive_uv_sphere_add(
        radius=0.15, location=(0, 0, 0.16), segments=16, ring_count=8
    )
    thing = bpy.context.object
    thing.name, thing.drape.role = "ball", "BODY"
    if moving:
        thing.keyframe_insert("location", index=0, frame=5)
        thing.location.x = 0.1
        thing.keyframe_insert("location", index=0, frame=5 + FRAMES)
    return thing


def shown(thing: Any, frame: int) -> np.ndarray:
    """The vertices of an object in the world at a frame."""
    bpy.context.scene.frame_set(frame)
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    pose = np.array(mesh.matrix_world)
    x = np.array([v.co for v in mesh.data.vertices])
    return x @ pose[:3, :3].T + pose[:3, 3]


def triangles(thing: Any) -> np.ndarray:
    """The triangles of an object."""
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    mesh.calc_loop_triangles()
    return np.array([t.vertices for t in mesh.loop_triangles], np.int32)


def refused(words: str) -> None:
    """Baking is refused by one line with these words."""
    with pytest.raises(RuntimeError) as error:
        bpy.ops.drape.bake()
    assert words in str(error.value) and str(error.value).strip().count("\n") == 0
