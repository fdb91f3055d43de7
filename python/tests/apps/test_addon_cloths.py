# SPDX-License-Identifier: Apache-2.0
"""What the Blender add-on takes as cloth: garments with UVs, grids of all kinds; what
moves them, pins, wind and modifiers; and what it says of the rest."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import charted
import charted_tee
import numpy as np
from needs import need

import drape
from apps.addon import FRAMES, addon, ball, refused, sheet, shown, triangles

bpy = need("bpy")
__all__ = ["addon"]
END = 5 + FRAMES
FAR = {"particles": [2, 2], "start": {"at": [9, 9, 9]}}


def warned(capfd: Any) -> str:
    """What a bake has said."""
    capfd.readouterr()
    assert bpy.ops.drape.bake() == {"FINISHED"}
    return str(capfd.readouterr().out)


def bring(file: Path, name: str, cell: float) -> Any:
    """A garment of an OBJ file."""
    bpy.ops.wm.obj_import(filepath=str(file))
    thing = bpy.context.selected_objects[0]
    thing.name, thing.drape.role, thing.drape.cell = name, "CLOTH", cell
    thing.drape.fabric = "cotton"
    return thing


def bodied(vertices: Any, tri: Any, name: str = "body") -> Any:
    """A body of a mesh of drape."""
    x = np.asarray(vertices, float)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        np.stack([x[:, 0], -x[:, 2], x[:, 1]], 1).tolist(), [], np.asarray(tri).tolist()
    )
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    thing.drape.role = "BODY"
    return thing


def boned(thing: Any, turn: float = 0.0, move: float = 0.0) -> Any:
    """Gives an object an armature of one bone, and that an action: it turns about
    the upright axis, and moves along x."""
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("hips")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    led = rig.pose.bones["hips"]
    led.rotation_mode = "XYZ"
    for frame, part in ((5, 0), (END, 1)):
        led.rotation_euler.y = part * turn  # a bone's y is along it
        led.location.x = part * move
        led.keyframe_insert("rotation_euler", frame=frame)
        led.keyframe_insert("location", frame=frame)
    ride(thing, rig)
    return rig


def ride(thing: Any, rig: Any) -> None:
    """Lets all of a mesh follow the bone."""
    group = thing.vertex_groups.new(name="hips")
    group.add(list(range(len(thing.data.vertices))), 1.0, "REPLACE")
    thing.modifiers.new("bones", "ARMATURE").object = rig


def pairs(things: list[Any], frame: int) -> int:
    """Pairs of triangles of objects that intersect, by the exact count; those of a
    garment's own mesh, which may cross at seams, apart."""
    x, tri, group, first = [], [], [], 0
    for k, thing in enumerate(things):
        x.append(shown(thing, frame))
        tri.append(triangles(thing) + first)
        group += [k] * len(tri[-1])
        first += len(x[-1])
    made = drape.audit(np.concatenate(x), np.concatenate(tri), np.int32(group))
    return int(made.count)


def watched(monkeypatch: Any) -> list[float]:
    """The largest gap of the seams before each step of the next bake, m."""
    gaps: list[float] = []

    class World(drape.World):
        def step(self, *arguments: Any) -> Any:
            gaps.append(max(np.abs(self.seam(k)[0]).max() for k in range(self.seams)))
            return super().step(*arguments)

    monkeypatch.setattr(drape, "World", World)
    return gaps


def test_a_shirt_with_uvs_is_a_garment(
    addon: Any, tmp_path: Path, capfd: Any, monkeypatch: Any
) -> None:
    file = charted_tee.tee(tmp_path / "flat").write(tmp_path / "tee.obj", unit=1)
    shirt = bring(file, "shirt", 0.04)
    shirt.drape.strain = 0.2  # by folds that the coarse cloth has
    world = drape.World(drape.Scene(obstacles=charted_tee.body(0.01), cloths=[FAR]))
    for each in world.bodies[1:]:
        tri = world.triangles[each.triangles] - each.vertices.start
        bodied(world.positions[each.vertices], tri)
    faces = [tuple(p.vertices) for p in shirt.data.polygons]
    uv = [tuple(each.vector) for each in shirt.data.uv_layers.active.uv]
    stuff = bpy.data.materials.new("jersey")
    shirt.data.materials.clear()
    shirt.data.materials.append(stuff)
    start = shown(shirt, 5)
    gaps = watched(monkeypatch)
    assert warned(capfd) == "Info: drape: 13 frames, 24 steps, 0 not clean\n"
    assert gaps[0] > 2e-3 and max(gaps[4:]) < 2e-4  # seams close
    assert np.abs(shown(shirt, 5) - start).max() < 0.01
    graph = bpy.context.evaluated_depsgraph_get()
    made = shirt.evaluated_get(graph).data
    assert [tuple(p.vertices) for p in made.polygons] == faces
    assert [tuple(each.vector) for each in made.uv_layers.active.uv] == uv
    assert [m.name for m in made.materials] == ["jersey"]
    for frame in (5, END):
        x = shown(shirt, frame)
        assert np.isfinite(x).all() and np.abs(x - start).max() < 0.2


def skirt(folder: Path) -> Any:
    """A skirt whose waist is a vertex group, of silk: it bends about its pins."""
    thing = bring(charted.tube().write(folder / "skirt.obj"), "skirt", 0.03)
    start = shown(thing, 5)
    top = np.flatnonzero(start[:, 2] > start[:, 2].max() - 1e-4)
    thing.vertex_groups.new(name="waist").add(top.tolist(), 1.0, "REPLACE")
    thing.drape.pins = "waist"
    thing.drape.fabric = "silk"
    return thing, top


def test_a_skirt_follows_a_body_with_an_action(
    addon: Any, tmp_path: Path, capfd: Any
) -> None:
    thing, top = skirt(tmp_path)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.14, location=(0, 0, 0.85))
    body = bpy.context.object
    body.drape.role = "BODY"
    # the origin of the body is the armature's
    bpy.ops.object.transform_apply()
    rig = boned(body, turn=0.4, move=0.1)
    ride(thing, rig)
    thing.matrix_world = thing.matrix_world
    before = shown(thing, END)  # as the bone leads it
    start = shown(thing, 5)
    assert warned(capfd) == "Info: drape: 13 frames, 24 steps, 0 not clean\n"
    end = shown(thing, END)
    assert np.abs(before[top] - start[top]).max() > 0.1
    assert np.abs(end[top] - before[top]).max() < 0.004  # pinned to the waist
    moved = (end - start).mean(0)
    assert moved[0] > 0.05  # all of it follows
    # as cloth does, not as the bone
    assert np.abs(end - before).max() > 4 * np.abs(end[top] - before[top]).max()
    assert [m.name for m in thing.modifiers] == ["bones", "drape"]
    for frame in (5, 9, END):
        x, y = shown(thing, frame), shown(body, frame)
        far = np.linalg.norm(x - y.mean(0), axis=1)
        assert far.min() > 0.13, frame


def test_pins_of_a_moved_object_move(addon: Any) -> None:
    cloth = sheet()
    cloth.vertex_groups.new(name="held").add([0, 12], 1.0, "REPLACE")
    cloth.drape.pins = "held"
    cloth.keyframe_insert("location", frame=5)
    cloth.location.z += 0.2
    cloth.keyframe_insert("location", frame=END)
    led = [shown(cloth, frame)[[0, 12]] for frame in range(5, END + 1)]
    start = shown(cloth, 5)
    bpy.ops.drape.bake()
    for frame in range(5, END + 1):
        assert np.abs(shown(cloth, frame)[[0, 12]] - led[frame - 5]).max() < 1e-5
    assert led[-1][0, 2] - start[0, 2] > 0.19
    assert shown(cloth, END)[100, 2] < start[100, 2]  # what is free falls


def test_a_flag_in_wind(addon: Any) -> None:
    flag = sheet("flag")
    flag.rotation_euler = (np.pi / 2, 0, 0)
    flag.vertex_groups.new(name="pole").add(list(range(0, 117, 13)), 1.0, "REPLACE")
    flag.drape.pins = "pole"
    start = shown(flag, 5)
    bpy.ops.drape.bake()
    still = shown(flag, END)
    bpy.ops.object.effector_add(type="WIND", rotation=(-np.pi / 2, 0, 0))  # along y
    wind = bpy.context.object
    wind.field.strength = 12
    bpy.ops.drape.bake()
    blown = shown(flag, END)
    assert abs((still - start)[:, 1].mean()) < 0.01
    assert (blown - start)[:, 1].mean() > 0.05
    for frame, strength in ((5, 0), (9, 12)):  # a wind that rises
        wind.field.strength = strength
        wind.keyframe_insert("field.strength", frame=frame)
    bpy.ops.drape.bake()
    risen = shown(flag, END)
    assert (risen - start)[:, 1].mean() > 0.05


def test_a_skirt_in_wind(addon: Any, tmp_path: Path) -> None:
    thing, top = skirt(tmp_path)
    start = shown(thing, 5)
    bpy.ops.object.effector_add(type="WIND", rotation=(-np.pi / 2, 0, 0))  # along y
    bpy.context.object.field.strength = 12
    bpy.ops.drape.bake()
    blown = shown(thing, END)
    assert np.abs(blown[top] - start[top]).max() < 0.002  # pinned to the waist
    low = start[:, 2] < start[:, 2].min() + 0.02
    assert (blown - start)[low, 1].mean() > 0.02


def holed(name: str = "holed") -> Any:
    """A sheet of 13 × 9 vertices that lacks a corner and cells inside."""
    import bmesh

    thing = sheet(name)
    made = bmesh.new()
    made.from_mesh(thing.data)
    made.faces.ensure_lookup_table()
    gone = [made.faces[k] for k in (0, 40, 41, 52, 53)]
    bmesh.ops.delete(made, geom=gone, context="FACES")
    made.to_mesh(thing.data)
    made.free()
    return thing


def test_grids_with_holes(addon: Any) -> None:
    cloth, body = holed(), ball()
    count = len(cloth.data.polygons)
    start = shown(cloth, 5)
    assert count == 91 and bpy.ops.drape.bake() == {"FINISHED"}
    assert np.allclose(shown(cloth, 5), start, atol=1e-6)
    assert 0.2 < (start[:, 2] - shown(cloth, END)[:, 2]).max() < 0.85
    assert pairs([cloth, body], END) == 0


def test_triangulated_and_subdivided_grids(addon: Any) -> None:
    import bmesh

    plain = sheet("plain")
    bpy.ops.drape.bake()
    expected = shown(plain, END)
    bpy.data.objects.remove(plain)
    cloth = sheet("cut")
    made = bmesh.new()
    made.from_mesh(cloth.data)
    bmesh.ops.triangulate(made, faces=made.faces[:])
    made.to_mesh(cloth.data)
    made.free()
    bpy.ops.drape.bake()
    assert len(cloth.data.polygons) == 192
    assert np.array_equal(shown(cloth, END), expected)
    bpy.data.objects.remove(cloth)
    fine = sheet("fine", 7, 5)
    made = bmesh.new()
    made.from_mesh(fine.data)
    bmesh.ops.subdivide_edges(made, edges=made.edges[:], cuts=1, use_grid_fill=True)
    made.to_mesh(fine.data)
    made.free()
    assert len(fine.data.vertices) == 117
    bpy.ops.drape.bake()
    end = shown(fine, END)
    assert abs(end[:, 2].mean() - expected[:, 2].mean()) < 1e-3


def test_modifiers_are_honoured_or_named(addon: Any, capfd: Any) -> None:
    cloth = sheet()
    lattice = bpy.data.objects.new("cage", bpy.data.lattices.new("cage"))
    bpy.context.collection.objects.link(lattice)
    lattice.scale = (2, 2, 2)
    lattice.location.z = 1
    cloth.modifiers.new("cage", "LATTICE").object = lattice
    for point in lattice.data.points:
        point.co_deform.z += 0.1  # the cloth is led upwards
    start = shown(cloth, 5)
    cloth.modifiers.new("finer", "SUBSURF").levels = 1
    assert "Warning" not in warned(capfd)
    assert [m.name for m in cloth.modifiers] == ["cage", "drape", "finer"]
    fine = shown(cloth, 5)
    assert len(fine) == 25 * 17 and abs(fine[:, 2].mean() - start[:, 2].mean()) < 1e-3
    assert start[:, 2].mean() > 0.4
    assert (fine - shown(cloth, END))[:, 2].max() > 0.3
    cloth.modifiers.new("off", "BEVEL").show_viewport = False
    cloth.modifiers.move(3, 0)
    assert "Warning" not in warned(capfd)
    assert [m.name for m in cloth.modifiers] == ["off", "cage", "drape", "finer"]
    assert np.array_equal(shown(cloth, 5), fine)
    cloth.modifiers.remove(cloth.modifiers["off"])
    cloth.modifiers.new("half", "MIRROR")
    cloth.modifiers.move(0, 3)
    said = warned(capfd)
    assert "sheet: what modifier half makes is not simulated: apply it" in said
    assert "sheet: modifier cage moves what is baked once more: put it before" in said
    assert [m.name for m in cloth.modifiers if not m.show_viewport] == []


def test_groups_weights_and_fields_are_named(addon: Any, capfd: Any) -> None:
    cloth = sheet()
    cloth.drape.pins = "held"
    refused("sheet: pins: there is no vertex group held; it has none")
    group = cloth.vertex_groups.new(name="held")
    refused("sheet: pins: no particle has a weight above 0.5 of held")
    group.add([0, 12], 1.0, "REPLACE")
    group.add([1, 11], 0.4, "REPLACE")
    bpy.ops.object.effector_add(type="TURBULENCE")
    said = warned(capfd)
    assert "pins: 2 vertices of held have weights between 0 and 1" in said
    assert "Turbulence: a force field of kind Turbulence has no effect" in said


def test_vertices_without_a_particle_are_named(
    addon: Any, tmp_path: Path, capfd: Any
) -> None:
    thing, _ = skirt(tmp_path)
    group = thing.vertex_groups["waist"]
    assert "pins" not in warned(capfd)
    group.remove(list(range(len(thing.data.vertices))))
    group.add([207], 1.0, "REPLACE")
    thing.drape.cell = 0.06
    refused("skirt: pins: no particle has a weight above 0.5 of waist; a garment of")
    group.add([0], 1.0, "REPLACE")  # in the corner of a chart, where a particle is
    assert "pins: of the vertices of waist 1 stay free, as no" in warned(capfd)


def test_what_is_hidden_and_units_are_named(addon: Any, capfd: Any) -> None:
    sheet()
    body = ball()
    bpy.context.scene.unit_settings.scale_length = 0.01
    body.hide_set(True)  # Blender computes it all the same
    assert "unit scale 0.01 has no effect: a unit of Blender is taken" in warned(capfd)
    body.hide_viewport = True
    refused("ball: it is disabled in viewports, so Blender does not compute it")
    body.drape.role = "NONE"
    bpy.ops.object.effector_add(type="WIND")
    wind = bpy.context.object
    wind.field.noise = 1
    assert "Wind: its noise has no effect" in warned(capfd)
    wind.hide_viewport = True
    assert "noise" not in warned(capfd)


def test_sheets_and_garments_together(addon: Any, tmp_path: Path, capfd: Any) -> None:
    """The garment is the first by its name, and the last in drape."""
    worn, top = skirt(tmp_path)
    worn.name = "a skirt"
    cloth = sheet()
    cloth.vertex_groups.new(name="held").add([0], 1.0, "REPLACE")
    cloth.drape.pins = "held"
    cloth.location.x = 2
    starts = [shown(thing, 5) for thing in (worn, cloth)]
    assert warned(capfd) == "Info: drape: 13 frames, 24 steps, 0 not clean\n"
    least = 2e-4, 2e-3  # a tube that hangs from its waist stays as it is, but for this
    each = zip((worn, cloth), starts, (top, [0]), least, strict=True)
    for thing, start, pinned, moves in each:
        way = np.linalg.norm(shown(thing, END) - start, axis=1)
        assert way[pinned].max() < 0.004 and moves < way.max() < 1
    assert np.abs(shown(worn, 5) - starts[0]).max() < 0.004
    assert np.abs(shown(cloth, 5) - starts[1]).max() < 1e-6


def test_what_cannot_be_taken_says_what_could(addon: Any) -> None:
    bpy.ops.mesh.primitive_cone_add()
    cone = bpy.context.object
    cone.drape.role = "CLOTH"
    refused("Cone: it is no grid of quads, expected faces of four vertices only; and")
    cone.data.uv_layers.remove(cone.data.uv_layers[0])
    refused("it has no UVs; a garment's charts are its panels: unwrap it first")


def test_frames_show_while_they_bake(addon: Any) -> None:
    cloth = sheet()
    before = shown(cloth, 9)
    work = addon.bake.bake(bpy.context.scene)
    seen = {}
    for result, _ in work:
        seen.setdefault(result.frames, shown(cloth, 4 + result.frames))
        if result.frames == 6:
            break
    work.close()  # as Esc does
    assert not cloth.modifiers and np.array_equal(shown(cloth, 9), before)
    bpy.ops.drape.bake()
    for frames, x in seen.items():
        assert np.array_equal(shown(cloth, 4 + frames), x), frames
    assert (before - seen[6])[:, 2].max() > 0.05
    end = shown(cloth, END)
    work = addon.bake.bake(bpy.context.scene)
    next(work)
    work.close()
    assert np.array_equal(shown(cloth, END), end)


class Window:
    """What a bake with a window asks of it."""

    def __init__(self) -> None:
        self.scene, self.window, self.window_manager = bpy.context.scene, None, self
        self.timers = 0
        self.progress: list[float] = []
        self.progress_update = self.progress.append

    def progress_begin(self, _low: float, _high: float) -> None: ...

    def progress_end(self) -> None: ...

    def modal_handler_add(self, _operator: Any) -> None: ...

    def event_timer_add(self, _seconds: float, window: Any) -> Any:
        assert window is self.window
        self.timers += 1
        return self

    def event_timer_remove(self, _timer: Any) -> None:
        self.timers -= 1


def operator(addon: Any) -> Any:
    """The operator, without Blender's own part, which wants a window."""
    said: list[str] = []
    inner = {k: v for k, v in vars(addon.DRAPE_OT_bake).items() if k[:2] != "__"}
    inner["report"] = lambda _self, _kind, words: said.append(words)
    inner["said"] = said
    return type("Operator", (), inner)()


def test_a_window_shows_frames_and_esc_ends(addon: Any) -> None:
    from types import SimpleNamespace

    cloth, window = sheet(), Window()
    made, scene = operator(addon), bpy.context.scene
    scene.frame_set(7)
    tick, key = SimpleNamespace(type="TIMER"), SimpleNamespace(type="ESC")
    assert made.invoke(window, None) == {"RUNNING_MODAL"} and window.timers == 1
    frames = []
    for _ in range(8):
        assert made.modal(window, tick) == {"RUNNING_MODAL"}
        frames.append(scene.frame_current)
    assert frames == [5, 5, 6, 6, 7, 7, 8, 8]  # two steps a frame
    assert made.modal(window, SimpleNamespace(type="MOUSEMOVE")) == {"PASS_THROUGH"}
    assert made.modal(window, key) == {"CANCELLED"} and window.timers == 0
    assert scene.frame_current == 7 and not cloth.modifiers
    assert made.said == ["drape: the bake was ended; nothing has changed"]
    made.invoke(window, None)
    while (end := made.modal(window, tick)) == {"RUNNING_MODAL"}:
        pass
    assert end == {"FINISHED"} and cloth.drape.baked == FRAMES + 1
    assert scene.frame_current == 7 and window.progress[-1] == 1
    assert made.said[-1] == "drape: 13 frames, 24 steps, 0 not clean"
