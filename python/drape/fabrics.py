# SPDX-License-Identifier: Apache-2.0
"""The fabrics that a scene's material may name."""

from __future__ import annotations

from dataclasses import dataclass

from ._core import ffi, lib
from .scene import Material


@dataclass(frozen=True)
class Fabric:
    """A fabric by name.

    Attributes:
        name: as a scene's material calls it
        what: it is, in words
        material: its numbers; nobody measured the damping
    """

    name: str
    what: str
    material: Material


def materials() -> dict[str, Fabric]:
    """Returns the fabrics by their names. ``drape materials`` prints the same with
    the source of each fabric's numbers."""
    found: dict[str, Fabric] = {}
    numbers, what = ffi.new("drape_material *"), ffi.new("char const **")
    while name := lib.fabric_at(len(found), numbers, what):
        fabric = Fabric(
            ffi.string(name).decode(),
            ffi.string(what[0]).decode(),
            Material(
                density=numbers.density,
                stretch=numbers.stretch,
                shear=numbers.shear,
                bend=numbers.bend,
                thickness=numbers.thickness,
                friction=numbers.friction,
            ),
        )
        found[fabric.name] = fabric
    return found
