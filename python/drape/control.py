# SPDX-License-Identifier: Apache-2.0
"""Live control: calls between two steps that change a world from the next step
on, and wake it (spec/control/control.md), and the contacts of the last step."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import scene as scenes
from ._core import ffi, lib
from ._define import Handle, read_scene
from ._library import Calls
from ._meshes import on_host
from ._signals import Held
from .arrays import address, order
from .bodies import Body, means
from .contacts import ROW, Contacts
from .errors import SceneError, check
from .fabrics import materials
from .reports import Status


def _copied(pointer: Any, count: int, kind: np.dtype[Any]) -> NDArray[Any]:
    """Copies an array of C's."""
    size = count * kind.itemsize
    data = bytes(ffi.buffer(ffi.cast("char *", pointer), size)) if size else b""
    return np.frombuffer(data, kind)


def _set_tables(new: Any, stretch: Mapping[str, Any]) -> None:
    """Sets a material's modulus and its measured tensions; what is not given stays,
    and an array of shape (0, 2) takes a table away."""
    for key, value in stretch.items():
        if key == "modulus":
            new.stretch = scenes.number(value, "material.stretch.modulus")
            continue
        if key not in scenes.TABLES:
            raise SceneError(fault_of("cloths", material={"stretch": {key: []}}))
        points = scenes.array(value, (None, 2), f"material.stretch.{key}")
        if len(points) > lib.DRAPE_POINTS:
            raise SceneError(
                f"material.stretch.{key}: {len(points)} points; expected at most "
                f"{lib.DRAPE_POINTS}"
            )
        zeros = np.zeros((lib.DRAPE_POINTS - len(points), 2))
        new.table[scenes.TABLES.index(key)] = np.vstack([points, zeros]).tolist()


def _set_numbers(new: Any, given: Mapping[str, Any]) -> None:
    """Sets numbers of a drape_material."""
    known = {f.name for f in dataclasses.fields(scenes.Material)} - {"name"}
    for key, value in given.items():
        if key not in known:
            raise SceneError(fault_of("cloths", material={key: 0}))
        if key == "stretch" and isinstance(value, Mapping):
            _set_tables(new, value)
        elif key == "limit":
            if np.ndim(value) == 0:
                one = scenes.number(value, "material.limit")
                value = [one, one, 2 * one]
            new.limit = scenes.array(value, (3,), "material.limit").tolist()
        else:
            setattr(new, key, scenes.number(value, f"material.{key}"))


def _set_fabric(new: Any, name: str) -> None:
    """Sets a material to a fabric's numbers. What nobody measured stays."""
    fabrics = materials()
    if name not in fabrics:
        raise SceneError(fault_of("cloths", material=name))
    _set_tables(new, dict.fromkeys(scenes.TABLES, np.empty((0, 2))))
    given = scenes.as_dict(fabrics[name].material)
    _set_numbers(new, {key: given[key] for key in given if key != "name"})


def fault_of(part: str, **keys: Any) -> str | None:
    """Returns what the scenes' reader says of keys of "cloths" or of "wind", which
    names the one that is wrong, its range and what was probably meant; None: they
    are right."""
    cloth = {"particles": [2, 2]}
    tree = {"cloths": [{**cloth, **keys}]} if part == "cloths" else {part: keys}
    try:
        read_scene(scenes.read({"cloths": [cloth], **tree}))
    except SceneError as error:
        return str(error).removeprefix("scene: $.").removeprefix("cloths[0].")
    return None


def _material_fault(new: Any) -> str | None:
    """Returns what is wrong with a material that the library has refused."""
    given: dict[str, Any] = {
        field.name: getattr(new, field.name)
        for field in dataclasses.fields(scenes.Material)
        if field.name not in ("name", "limit")
    }
    return fault_of("cloths", material={**given, "limit": list(new.limit)})


def told(refused: SceneError, text: str | None) -> SceneError:
    """Returns what the library has refused with a text that says more."""
    told = SceneError(text) if text else refused
    told.status = refused.status
    return told


def _pins_fault(who: NDArray[np.int32], count: int) -> str:
    """Returns what is wrong with pins that the library has refused."""
    for k in who:
        if not 0 <= k < count:
            return f"particle {k}: expected a number from 0 to {count - 1}"
    twice = np.flatnonzero(np.bincount(who, minlength=1) > 1)
    if len(twice):
        return f"particle {twice[0]} is there twice"
    return "one of the particles is missing: it is in a hole or a cut"


class Control:
    """What a `World` adds to its steps. A call that is refused changes nothing.

    Arrays of CUDA (torch, CuPy, Warp) are taken where they lie by a world on
    the same device, if they have the world's precision; all others are read as
    binary64 on the host. What a call was given may be changed after it.
    """

    _calls: Calls
    bodies: tuple[Any, ...]

    def _open(self) -> Handle:
        raise NotImplementedError

    def _refresh(self) -> None:
        raise NotImplementedError

    def _one(self, body: int | str | Any, kind: str) -> tuple[int, Any]:
        """Returns a body's number among those of its kind, and the body."""
        alike = [each for each in self.bodies if each.kind == kind]
        for k, each in enumerate(alike):
            if means(body, k, each):
                return k, each
        text = reprlib.repr(getattr(body, "name", body))
        names = reprlib.repr([each.name for each in alike])
        raise SceneError(
            f"{text}: there is no such {kind}; expected a number, a name or a Body "
            f"of {names}"
        )

    def _call(self, name: str, where: str, *arguments: Any) -> int:
        """Calls a function of the library that takes the world first."""
        handle = self._open()
        with handle.lock:
            status = getattr(lib, name)(handle.world, *arguments)
        return check(status, where)

    def _vectors(
        self,
        name: str,
        where: str,
        before: tuple[Any, ...],
        value: Any,
        n: int,
        after: tuple[Any, ...] = (),
    ) -> None:
        """Calls the form of a function that reads [n, 3] vectors where they are."""
        pointer, kept = self._on_device(value, n, where)
        if pointer is None:
            kept = scenes.array(value, (n, 3), where)
            pointer = ffi.cast("double (*)[3]", kept.ctypes.data)
        else:
            name += "_device"
        self._call(name, where, *before, pointer, *after)
        del kept

    def _on_device(self, value: Any, n: int, where: str) -> tuple[Any, Any]:
        """Returns the address of an array of CUDA for a world on a device."""
        definition = self._open().definition
        about = getattr(value, "__cuda_array_interface__", None)
        if about is None:
            return None, None
        kind = f"<f{definition.precision // 8}"
        if definition.backend != lib.DRAPE_GPU:
            raise SceneError(f"{where}: an array of CUDA, for a world on the host")
        if (about["shape"], about["typestr"]) != ((n, 3), kind) or about.get("strides"):
            raise SceneError(
                f"{where}: {about['shape']} of {about['typestr']}; expected "
                f"({n}, 3) of {kind}, one row after the other"
            )
        view = ffi.new("drape_view *")
        self._call("drape_borrow", where, view)
        order(ffi.cast("void *", about.get("stream") or 1), address(view.stream) or 1)
        return ffi.cast("void *", about["data"][0]), value

    def _rows(
        self, what: str, cloth: Any, vectors: Any, first: int | None
    ) -> tuple[str, Any, int, int]:
        """Returns what an array of vectors of cloths is called, the array, and
        where in the scene and of how many rows it is."""
        if first is not None:
            first = scenes.whole(first, "first")
        if vectors is None:
            if isinstance(cloth, (str, Body)):
                raise SceneError(
                    f"{what}: expected an array, as in set_{what}(cloth, array)"
                )
            where, vectors, start = what, cloth, 0
            end = max(b.vertices.stop for b in self.bodies if b.kind == "cloth")
            whose = "the vertices of cloths are"
            first = first or 0
        else:
            _, body = self._one(cloth, "cloth")
            where, start = f"{body.name}: {what}", body.vertices.start
            end = body.vertices.stop - start
            whose = "its vertices are"
            if first is None:
                return where, vectors, start, end
        n = len(vectors) if hasattr(vectors, "__len__") else 1
        if not 0 <= first <= end - n:
            raise SceneError(
                f"{where}: {n} rows from vertex {first} on; {whose} 0 to {end - 1}"
            )
        return where, vectors, start + first, n

    # What is changed

    @property
    def gravity(self) -> NDArray[np.float64]:
        """[3] m/s², of the next step: as defined, set, loaded or replayed."""
        g = ffi.new("double [3]")
        self._call("drape_read_gravity", "gravity", g)
        return np.array(list(g))

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Sets gravity, [3] m/s²."""
        g = scenes.array(gravity, (3,), "gravity")
        self._call("drape_set_gravity", "gravity", g.tolist())

    @property
    def seams(self) -> int:
        """How many seams there are, which have the numbers from 0 on."""
        return int(self._open().definition.n_seams)

    def seam(self, seam: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns what a seam is like: the gap of each point, [points, 3] m, its
        particle minus its place, and the seam's pull on the particle, [points, 3] N.

        Args:
            seam: its number, in the order of the garments and of their stitches
        """
        n = self._points(seam)
        gap, pull = np.empty((n, 3)), np.empty((n, 3))
        here = [ffi.cast("double (*)[3]", a.ctypes.data) for a in (gap, pull)]
        self._call("drape_seam_state", f"seam {seam}", seam, *here)
        return gap, pull

    def set_seam(self, seam: int, gap: ArrayLike | None = None) -> None:
        """Sets the gaps that a seam is to have from the end of the next step on.

        Args:
            seam: its number
            gap: [points, 3] m, particle minus place; None: it is to be closed
        """
        n, target = self._points(seam), ffi.NULL
        if gap is not None:
            kept = scenes.array(gap, (n, 3), f"seam {seam}: gap")
            target = ffi.cast("double (*)[3]", kept.ctypes.data)
        self._call("drape_seam_target", f"seam {seam}", seam, target)

    def _points(self, seam: int) -> int:
        """Returns how many points a seam has."""
        definition = self._open().definition
        if not 0 <= scenes.whole(seam, "seam") < self.seams:
            raise SceneError(f"seam {seam}: there is no such seam, of {self.seams}")
        return int(definition.seams[seam].n)

    def set_material(
        self,
        cloth: int | str | Any,
        material: str | scenes.Material | Mapping[str, Any],
    ) -> None:
        """Sets numbers of a cloth's material; those not given stay.

        Args:
            cloth: its number, name or `Body`
            material: as in a scene: a fabric's name, or numbers, which override
                those of a fabric that is named beside them. An array of shape
                (0, 2) in `stretch` makes a direction linear again
        """
        k, _ = self._one(cloth, "cloth")
        new = ffi.new("drape_material *")
        self._call("drape_read_material", "material", k, new)
        given = {"name": material} if isinstance(material, str) else material
        given = dict(
            scenes.mapping(given, "material", "a fabric's name or its numbers")
        )
        if (name := given.pop("name", None)) is not None:
            _set_fabric(new, name)
        _set_numbers(new, given)
        try:
            self._call("drape_set_material", "material", k, new)
        except SceneError as refused:
            raise told(refused, _material_fault(new)) from None

    def set_positions(
        self, cloth: Any, positions: Any = None, *, first: int | None = None
    ) -> None:
        """Sets where vertices of cloths are. The world forgets its past; entries of
        pinned particles are not used. ``set_positions(positions)`` sets those of
        the scene's vertices from its first one on.

        Args:
            cloth: its number, name or `Body`
            positions: [n, 3] m, of all its vertices
            first: the vertex of the cloth, or of the scene, that the positions
                begin with; they may then be fewer
        """
        where, x, at, n = self._rows("positions", cloth, positions, first)
        error = ffi.new("drape_error *")
        try:
            with Held():
                self._vectors("drape_set_positions", where, (at, n), x, n, (error,))
                self._refresh()
        except SceneError as refused:
            text = ffi.string(error.text).decode(errors="replace")
            raise told(refused, text and f"{where}: {text}") from None

    def set_velocities(
        self, cloth: Any, velocities: Any = None, *, first: int | None = None
    ) -> None:
        """Sets velocities of vertices of cloths, [n, 3] m/s, likewise."""
        where, v, at, n = self._rows("velocities", cloth, velocities, first)
        with Held():
            self._vectors("drape_set_velocities", where, (at, n), v, n)
            self._refresh()

    def _put_pins(self, k: int, particles: ArrayLike, targets: Any) -> None:
        """Sets the pins of cloth k, in place of all that it has."""
        body = [each for each in self.bodies if each.kind == "cloth"][k]
        where = f"{body.name}: pins"
        who = on_host(particles)
        who = scenes.array(
            who if who.size else np.empty(0, np.int32), (None,), where, np.int32
        )
        before = (k, len(who), ffi.cast("int32_t *", who.ctypes.data))
        try:
            if targets is None:
                self._call("drape_set_pins", where, *before, ffi.NULL)
            else:
                self._vectors("drape_set_pins", where, before, targets, len(who))
        except SceneError as refused:
            c = self._open().definition.cloths[k]
            fault = f"{where}: {_pins_fault(who, c.m * c.n)}"
            raise told(
                refused, fault if refused.status == Status.EARG else None
            ) from None

    def _put_pose(
        self,
        obstacle: int | str | Any,
        position: scenes.Vector,
        rotation: scenes.Vector | None,
        pivot: scenes.Vector | None,
    ) -> int:
        """Tells an obstacle its pose, and returns its number."""
        k, body = self._one(obstacle, "obstacle")
        p = scenes.array(position, (3,), "position").tolist()
        none = ffi.NULL
        q = none if rotation is None else scenes.array(rotation, (4,), "rotation")
        c = none if pivot is None else scenes.array(pivot, (3,), "pivot")
        rest = (each if each is none else each.tolist() for each in (q, c))
        self._call("drape_set_pose", f"{body.name}: pose", k, p, *rest)
        return k

    # What is told

    def contacts(self) -> Contacts:
        """Returns the pairs that were closer than their thickness, or met, in the
        last slice of the last step that was not skipped. None of an explicit
        integrator's: that is a SceneError."""
        c, handle = ffi.new("drape_contact_list *"), self._open()
        with handle.lock:
            check(lib.drape_contacts(handle.world, c), "contacts")
            rows = _copied(c.contact, c.n, ROW)
            flat = _copied(c.impulse, 3 * len(self.bodies), np.dtype("f8"))
        return Contacts(
            kind=rows["kind"],
            vertices=rows["vertex"],
            bodies=rows["body"],
            weights=rows["weight"],
            normals=rows["normal"],
            gaps=rows["gap"],
            impulses=rows["impulse"],
            dt=c.dt,
            body_impulses=flat.reshape(-1, 3),
            count=int(lib.drape_vertices(handle.made)),
        )
