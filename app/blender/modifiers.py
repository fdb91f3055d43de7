# SPDX-License-Identifier: Apache-2.0
"""The modifiers of a cloth. Those before the first one that makes other vertices
*lead* it: they say where it starts, and where its pins go. The point cache comes
after them, and the others show on what is baked."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

import bpy

NAME = "drape"  # of the modifier that shows what is baked

# Those behind that would move once more what has moved already.
AGAIN = ("ARMATURE", "CURVE", "HOOK", "LATTICE", "MESH_DEFORM", "SHRINKWRAP")
AGAIN += ("SURFACE_DEFORM", "CLOTH", "SOFT_BODY", "MESH_CACHE", "MESH_SEQUENCE_CACHE")
# Those behind whose cloth is not simulated.
MORE = ("ARRAY", "BOOLEAN", "MASK", "MIRROR", "SCREW", "SKIN")


def _kinds() -> dict[str, str]:
    """Blender's kind of each type of modifier: Modify, Generate, Deform or Physics."""
    found, kind = {}, ""
    rows = bpy.types.Modifier.bl_rna.properties["type"].enum_items_static_ui
    for row in rows:  # a row without identifier is the heading of those that follow
        kind = kind if row.identifier else row.name
        found[row.identifier] = kind
    return found


def leaders(thing: Any) -> int:
    """The number of modifiers, from the first on, that lead an object, without the
    one that shows what is baked. Those that are off are no matter."""
    kinds = _kinds()
    others = [m for m in thing.modifiers if m.name != NAME]
    for k, modifier in enumerate(others):
        if not modifier.show_viewport:
            continue
        if kinds[modifier.type] == "Physics" and modifier.type != "COLLISION":
            return k
        if kinds[modifier.type] == "Generate":
            return k
    return len(others)


def _behind(thing: Any) -> list[Any]:
    """The modifiers that do not lead an object."""
    others = [m for m in thing.modifiers if m.name != NAME]
    return others[leaders(thing) :]


@contextlib.contextmanager
def leading(things: Iterable[Any]) -> Iterator[None]:
    """Within, objects have only the modifiers that lead them."""
    hidden = []
    try:
        for thing in things:
            cache = thing.modifiers.get(NAME)
            for modifier in [*([cache] if cache else []), *_behind(thing)]:
                hidden.append((modifier, modifier.show_viewport))
                modifier.show_viewport = False
        yield
    finally:
        for modifier, shown in hidden:
            modifier.show_viewport = shown


def notes(thing: Any) -> list[str]:
    """What modifiers that do not lead an object do that may not be wanted."""
    found = []
    for modifier in _behind(thing):
        if not modifier.show_viewport:
            continue
        if modifier.type in AGAIN:
            first = _behind(thing)[0].name
            found.append(
                f"{thing.name}: modifier {modifier.name} moves what is baked once more"
                + (f": put it before {first}" if first != modifier.name else "")
            )
        if modifier.type in MORE:
            found.append(
                f"{thing.name}: what modifier {modifier.name} makes is not simulated: "
                "apply it where that is cloth"
            )
    return found
