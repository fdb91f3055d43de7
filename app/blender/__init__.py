# SPDX-License-Identifier: Apache-2.0
"""drape in Blender: marks objects as cloth or body, bakes, and scrubs.

Select a mesh that is a grid of quads, or a garment with UVs, make it a cloth in the
sidebar's tab drape and choose its fabric; make other meshes bodies; bake. The timeline
shows the result, which a Mesh Cache modifier reads.
"""

import functools
import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty

from . import bake

MISSING = (
    "Blender's Python has no package drape: install the extension that "
    "app/blender/pack.py builds, or the wheel of drape-cloth"
)
_items: list[tuple[str, str, str]] = []  # Blender needs them kept


@functools.cache
def fabrics() -> dict[str, str]:
    """The fabrics of drape, with what each is: app/scene/fabrics.def, which is packed."""
    here = Path(__file__).resolve().parent
    table = here / "fabrics.def"
    table = table if table.exists() else here.parent / "scene/fabrics.def"
    row = r'FABRIC\("([^"]+)",[^"]*"([^"]*)"'
    return dict(re.findall(row, table.read_text(encoding="utf-8")))


def fabric_items(_self: Any, _context: Any) -> list[tuple[str, str, str]]:
    """The fabrics as Blender's menu takes them."""
    _items[:] = [(name, name, words) for name, words in fabrics().items()]
    return _items


class DRAPE_PG_object(bpy.types.PropertyGroup):
    """What an object is to drape."""

    role: EnumProperty(  # type: ignore[valid-type]
        name="Role",
        items=[
            ("NONE", "None", "drape does not see this object"),
            ("CLOTH", "Cloth", "A grid of quads, or a garment of UV charts"),
            ("BODY", "Body", "A mesh that cloth collides with and does not push"),
        ],
    )
    fabric: EnumProperty(name="Fabric", items=fabric_items)  # type: ignore[valid-type]
    pins: StringProperty(  # type: ignore[valid-type]
        name="Pins", description="Vertex group of the particles that are held"
    )
    thickness: FloatProperty(  # type: ignore[valid-type]
        name="Thickness",
        description="Distance at which contact begins; 0: the fabric's",
        unit="LENGTH",
        min=0,
        max=1,
        precision=4,
    )
    cell: FloatProperty(  # type: ignore[valid-type]
        name="Cell",
        description="Side of a garment's cells; a grid of quads has its own",
        unit="LENGTH",
        default=0.01,
        min=0.001,
        max=0.1,
        precision=4,
    )
    strain: FloatProperty(  # type: ignore[valid-type]
        name="Strain",
        description="Of a chart against its UVs, above which these are no pattern",
        default=0.05,
        min=0,
        max=1,
    )
    friction: FloatProperty(  # type: ignore[valid-type]
        name="Friction",
        description="Coulomb's coefficient; below 0: the fabric's, 0.3 for a body",
        default=-1,
        min=-1,
        max=10,
    )
    baked: IntProperty()  # type: ignore[valid-type]


class DRAPE_PG_scene(bpy.types.PropertyGroup):
    """How a scene is baked."""

    steps: IntProperty(  # type: ignore[valid-type]
        name="Steps a frame",
        description="0: as many as a step of at most 1/60 s needs",
        min=0,
        max=100,
    )
    backend: EnumProperty(  # type: ignore[valid-type]
        name="Backend",
        items=[("ref", "CPU", ""), ("gpu", "NVIDIA GPU", "The same bits")],
    )


class DRAPE_OT_bake(bpy.types.Operator):
    """Simulate all cloths of the scene, from its first frame to its last one."""

    bl_idname = "drape.bake"
    bl_label = "Bake"
    _work: Iterator[tuple[bake.Result, int]]
    _timer: Any = None
    _frames = 0  # that are shown

    def _advance(self, context: Any) -> set[str] | None:
        """Makes a step; returns what Blender wants at the end."""
        try:
            self._result, frames = next(self._work)
        except StopIteration:
            return self._done(context)
        except Exception as error:  # drape's errors are one line, as bake's
            self._clear(context)
            self.report({"ERROR"}, f"drape: {error}")
            return {"CANCELLED"}
        context.window_manager.progress_update(self._result.frames / frames)
        if self._timer and self._result.frames > self._frames:
            self._frames = self._result.frames
            context.scene.frame_set(context.scene.frame_start + self._frames - 1)
        return None

    def _done(self, context: Any) -> set[str]:
        self._clear(context)
        r = self._result
        for note in r.notes:
            self.report({"WARNING"}, f"drape: {note}")
        words = f"drape: {r.frames} frames, {r.steps} steps, {r.not_clean} not clean"
        self.report({"WARNING" if r.not_clean else "INFO"}, words)
        return {"FINISHED"}

    def _clear(self, context: Any) -> None:
        self._work.close()  # type: ignore[attr-defined]
        context.window_manager.progress_end()
        if self._timer:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
            context.scene.frame_set(self._before)

    def _begin(self, context: Any) -> bool:
        try:
            importlib.import_module("drape")
        except ImportError as error:  # it says where PyPI's drape is in the way
            absent = isinstance(error, ModuleNotFoundError) and error.name == "drape"
            self.report({"ERROR"}, MISSING if absent else f"drape: {error}")
            return False
        self._work = bake.bake(context.scene)
        context.window_manager.progress_begin(0, 1)
        return True

    def execute(self, context: Any) -> set[str]:
        """Bakes in one go."""
        if not self._begin(context):
            return {"CANCELLED"}
        while (end := self._advance(context)) is None:
            pass
        return end

    def invoke(self, context: Any, _event: Any) -> set[str]:
        """Bakes a step at each tick of a timer, so that frames show and Esc ends it."""
        self._before, self._frames = context.scene.frame_current, 0
        if not self._begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.001, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set[str]:
        """Takes a tick, or Esc."""
        if event.type == "ESC":
            self._clear(context)
            self.report({"INFO"}, "drape: the bake was ended; nothing has changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        return self._advance(context) or {"RUNNING_MODAL"}


class DRAPE_OT_free(bpy.types.Operator):
    """Remove the baked frames of all cloths of the scene."""

    bl_idname = "drape.free"
    bl_label = "Free"

    def execute(self, context: Any) -> set[str]:
        """Removes modifiers and caches."""
        for thing in bake.role(context.scene, "CLOTH"):
            bake.free(thing)
            thing.drape.baked = 0
        return {"FINISHED"}


class DRAPE_PT_panel(bpy.types.Panel):
    """The tab of the sidebar."""

    bl_label = "drape"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "drape"

    def draw(self, context: Any) -> None:
        """Draws the object's settings and the scene's."""
        layout, thing = self.layout, context.object
        layout.use_property_split = True
        if thing and thing.type == "MESH":
            layout.prop(thing.drape, "role")
            if thing.drape.role == "CLOTH":
                layout.prop(thing.drape, "fabric")
                layout.prop_search(thing.drape, "pins", thing, "vertex_groups")
                layout.prop(thing.drape, "cell")
                layout.prop(thing.drape, "strain")
                layout.prop(thing.drape, "thickness")
            if thing.drape.role != "NONE":
                layout.prop(thing.drape, "friction")
        layout.prop(context.scene.drape, "steps")
        layout.prop(context.scene.drape, "backend")
        layout.operator("drape.bake")
        layout.operator("drape.free")


CLASSES = (
    DRAPE_PG_object,
    DRAPE_PG_scene,
    DRAPE_OT_bake,
    DRAPE_OT_free,
    DRAPE_PT_panel,
)


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Object.drape = bpy.props.PointerProperty(type=DRAPE_PG_object)
    bpy.types.Scene.drape = bpy.props.PointerProperty(type=DRAPE_PG_scene)


def unregister() -> None:
    """Called by Blender when the add-on is disabled."""
    del bpy.types.Scene.drape
    del bpy.types.Object.drape
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
