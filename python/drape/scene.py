# SPDX-License-Identifier: Apache-2.0
"""Scenes as objects. Their fields are the keys of a scene's file, which
app/scenes/README.md describes with ranges and defaults; a field that is None is
left out, so that the default is the reader's own.

Arrays are beyond what a file holds: a cloth may be given its `positions` and
`velocities`, an obstacle its `vertices`, `triangles` and `vertex_frames`, or as its
`mesh` an object that has these. They may be NumPy's, torch's, CuPy's or Warp's.
"""

from __future__ import annotations

import dataclasses
import json
import operator
import os
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _meshes, _whole
from ._endings import PYTHONS
from .errors import SceneError

# A list or an array of numbers.
Vector = Sequence[float] | NDArray[Any]

# How keys are given, by the class that somebody may give values without names.
EXAMPLES = {
    "Cloth": "particles=[51, 51]",
    "Obstacle": "mesh=…",
    "Material": 'name="denim"',
    "Scene": "cloths=[…]",
}


def _same(a: Any, b: Any) -> bool:
    """Whether two values of keys say the same. A list, a tuple and an array are
    the same if their numbers are."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_same, a, b))
    if hasattr(a, "__array__") or hasattr(b, "__array__"):
        return _meshes.same(a, b)
    return bool(a == b)


LONG = 80  # characters of a key's value beyond which its beginning is shown


def _short(value: Any) -> str:
    """Returns a key's value in few words."""
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return f"<{' × '.join(map(str, value.shape))} {value.dtype}>"
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], Keys):
        return f"[{', '.join(map(_short, value))}]"
    text = repr(value)
    short = isinstance(value, Keys) or len(text) <= LONG
    return text if short else reprlib.repr(value)


# Where a scene has an object of a class whose keys are given.
PLACES: dict[str, Callable[[Any], Any]] = {
    "Scene": lambda keys: keys,
    "Cloth": lambda keys: {"cloths": [keys]},
    "Start": lambda keys: {"cloths": [{"start": keys}]},
    "Material": lambda keys: {"cloths": [{"material": keys}]},
    "Pin": lambda keys: {"cloths": [{"pins": [keys]}]},
    "Panel": lambda keys: {"cloths": [{"panel": keys}]},
    "Garment": lambda keys: {"garments": [keys]},
    "Attach": lambda keys: {"garments": [{"attach": [keys]}]},
    "Region": lambda keys: {"cloths": [{"holes": [keys]}]},
    "Look": lambda keys: {"cloths": [{"look": keys}]},
    "Obstacle": lambda keys: {"obstacles": [keys]},
    "Frames": lambda keys: {"obstacles": [{"frames": keys}]},
    "Motion": lambda keys: {"motions": [keys]},
    "Key": lambda keys: {"motions": [{"keys": [keys]}]},
    "Wind": lambda keys: {"wind": keys},
    "Camera": lambda keys: {"camera": keys},
}


def _unknown(kind: str, key: str) -> str:
    """Returns what the scenes' reader says of a key that a class does not have."""
    from ._define import read_scene

    try:
        read_scene(read(PLACES[kind]({key: 0})))
    except SceneError as error:
        _, word, rest = str(error).partition("unknown key ")
        if word:
            return word + rest
    return f'unknown key "{key}"'


T = TypeVar("T", bound="Keys")


class Keys:
    """Keys of a scene, which are given by their names."""

    def __new__(cls: type[T], *values: Any, **keys: Any) -> T:
        """Refuses values without names, which might be taken for other keys', and
        keys that are none."""
        name = cls.__name__
        known = {key.name for key in dataclasses.fields(cls)}  # type: ignore[arg-type]
        for key in keys.keys() - known:
            raise TypeError(f"drape.{name}: {_unknown(name, key)}")
        if values:
            given = ", ".join(map(reprlib.repr, values))
            example = EXAMPLES.get(name, "key=value")
            raise TypeError(
                f"drape.{name}({given}): keys are given by their names, as in "
                f"drape.{name}({example})"
            )
        return object.__new__(cls)

    def __repr__(self) -> str:
        """The keys that are given, arrays by their shape and type."""
        pairs = (
            (key.name, getattr(self, key.name))
            for key in dataclasses.fields(self)  # type: ignore[arg-type]
        )
        words = (
            f"{name}={_short(value)}" for name, value in pairs if value is not None
        )
        return f"drape.{type(self).__name__}({', '.join(words)})"

    def __eq__(self, other: object) -> bool:
        """Whether all keys say the same, arrays by their numbers."""
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _same(getattr(self, key.name), getattr(other, key.name))
            for key in dataclasses.fields(self)  # type: ignore[arg-type]
        )


@dataclass(kw_only=True, eq=False, repr=False)
class Wind(Keys):
    """Air that moves with one velocity everywhere.

    Attributes:
        velocity: [3] m/s
        density: of air, kg/m³
        drag, lift: coefficients of a triangle along and across the flow
    """

    velocity: Vector | None = None
    density: float | None = None
    drag: float | None = None
    lift: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Camera(Keys):
    """Where pictures are taken from.

    Attributes:
        eye, target: [3] m
        fov: degrees of the picture's height
        turn: degrees a second that it goes about target, in a film
        sun: [3] direction towards the sun; light: its strength
        floor: [3] colour of a level obstacle, which is drawn without an end
    """

    eye: Vector | None = None
    target: Vector | None = None
    fov: float | None = None
    turn: float | None = None
    sun: Vector | None = None
    light: float | None = None
    floor: Vector | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Look(Keys):
    """How a body looks in pictures.

    Attributes:
        colour, inside: [3] sRGB, 0 … 1; inside: a cloth's other side
        gloss: how much the sun shines in it, 0 … 1
        check: of cloth: woven in squares of 4 cm
    """

    colour: Vector | None = None
    inside: Vector | None = None
    gloss: float | None = None
    check: bool | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Key(Keys):
    """A keyframe of a motion.

    Attributes:
        time: s
        move: [3] m from the start
        angle: degrees about axis
        axis: [3]
    """

    time: float | None = None
    move: Vector | None = None
    angle: float | None = None
    axis: Vector | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Motion(Keys):
    """A rigid motion by keyframes, which bodies and pins call by its name.

    Attributes:
        pivot: [3] m, the point that the turn goes about
    """

    name: str | None = None
    pivot: Vector | None = None
    keys: Sequence[Key] | None = None


# The directions of measured tensions, in the order of enum drape_table.
TABLES = ("warp", "weft", "bias")


@dataclass(kw_only=True, eq=False, repr=False)
class Material(Keys):
    """What cloth is made of: a fabric's name, and numbers that override its own.

    Attributes:
        density: kg/m²
        stretch: N/m, tension a width for strain 1; or a mapping of that
            "modulus" and of measured tensions "warp", "weft" and "bias", each a
            list of [strain, N/m]
        shear: N/m, likewise
        bend: N·m, moment a width for curvature 1
        damping: s
        thickness: m, distance at which contact begins
        friction: Coulomb coefficient
        limit: of strain along u, along v and of the shear angle, or one number
    """

    name: str | None = None
    density: float | None = None
    stretch: float | Mapping[str, Any] | None = None
    shear: float | None = None
    bend: float | None = None
    damping: float | None = None
    thickness: float | None = None
    friction: float | None = None
    limit: float | Vector | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Start(Keys):
    """Where and how a cloth starts.

    Attributes:
        shape: "flat", "hung" or "rolled"
        at, u, v: [3] m, place and directions
        folds: of a hung cloth, across its width; depth: their amplitude, m
        radius, gap: of a roll, m
    """

    shape: str | None = None
    at: Vector | None = None
    u: Vector | None = None
    v: Vector | None = None
    folds: int | None = None
    depth: float | None = None
    radius: float | None = None
    gap: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Region(Keys):
    """A part of a sheet at rest, m from its corner u0 v0.

    Attributes:
        disc: x, y, r
        rect: x0, y0, x1, y1
    """

    disc: Vector | None = None
    rect: Vector | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Pin(Keys):
    """Particles that are held, or led by a motion.

    Attributes:
        edge: "u0", "u1", "v0" or "v1"; every: m between its pins
        at: [2] m at rest, the nearest particle
        outline: the number of an edge of a panel's pattern, all its particles
        motion: the name of the motion that leads them
    """

    edge: str | None = None
    at: Vector | None = None
    every: float | None = None
    outline: int | None = None
    motion: str | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Panel(Keys):
    """A panel of a sewing pattern, cut to cells as `drape pattern` does.

    Attributes:
        pattern: a JSON file as GarmentCode writes it
        name: of the panel; a pattern of one panel needs none
        cell: m, side of a cell
    """

    pattern: str | None = None
    name: str | None = None
    cell: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Attach(Keys):
    """Edges of a garment's pattern that `drape.sew` holds where they are once it is
    worn.

    Attributes:
        label: of the edges
        to: "body", with the nearest place of which they move; or "world"
        hold: "soft", by `strength` at most; or "hard", by any force
        strength: N per metre of the edges; default: 30
        until: s after which they are let go; default: never
    """

    label: str | None = None
    to: str | None = None
    hold: str | None = None
    strength: float | None = None
    until: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Garment(Keys):
    """All panels of a sewing pattern, each a cloth of its name, and their seams, a
    stitch each. Seams hold what they have at the start: `drape sew` closes them.

    Attributes:
        pattern: a JSON file as GarmentCode writes it
        name: before the names of its panels; without it they stand alone
        cell: m, side of a cell
        material: a fabric's name, a Material or a mapping
        at: [3] m, where the pattern's origin is
        sewn: a PLY mesh of its particles, as `drape sew` writes, where it starts
        attach: a list of Attach, what `drape.sew` holds; default: the edges of the
            label "lower_interface" to which nothing is sewn, softly
        look: of all its panels
    """

    pattern: str | os.PathLike[str] | None = None
    name: str | None = None
    cell: float | None = None
    material: str | Material | Mapping[str, Any] | None = None
    at: Vector | None = None
    sewn: str | None = None
    attach: Sequence[Attach] | None = None
    look: Look | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Cloth(Keys):
    """A rectangular sheet of m × n particles, or a panel.

    Attributes:
        panel: of a sewing pattern, without `particles`, `size`, `holes`, `cuts`
        particles: m along u and n along v
        size: width and height at rest, m
        velocity: [3] m/s, of all particles at the start
        material: a fabric's name, a Material or a mapping
        bending: "triples" or "springs"
        positions: [m·n, 3] m, where the particles start, instead of `start`;
            particle (i, j) is number i + m·j
        velocities: [m·n, 3] m/s, instead of `velocity`
    """

    name: str | None = None
    panel: Panel | None = None
    particles: Vector | None = None
    size: Vector | None = None
    start: Start | None = None
    velocity: Vector | None = None
    material: str | Material | Mapping[str, Any] | None = None
    bending: str | None = None
    holes: Sequence[Region] | None = None
    cuts: Sequence[Region] | None = None
    pins: Sequence[Pin] | None = None
    look: Look | None = None
    positions: ArrayLike | None = None
    velocities: ArrayLike | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Frames(Keys):
    """Numbered mesh files of an obstacle that deforms.

    Attributes:
        files: with one %d or %04d in the name
        first, count: number of the first file, 0 or 1, and how many there are:
            as many as follow each other
        file: instead of these a point cache (.pc2) of the mesh that the obstacle
            has, a .ply or .off file
        dt: s between frames, or times: s, ascending, one a frame
        between: frames: "linear" or "cubic"
        lead: s in which the mesh that the obstacle has goes to the first frame,
            unless it is there
    """

    files: str | None = None
    first: int | None = None
    count: int | None = None
    file: str | os.PathLike[str] | None = None
    dt: float | None = None
    times: Vector | None = None
    between: str | None = None
    lead: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Bend(Keys):
    """How far a limb is bent at a time.

    Attributes:
        time: s; angle: degrees
    """

    time: float | None = None
    angle: float | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Obstacle(Keys):
    """A mesh that cloth collides with: from a file, made in code, or arrays.

    Attributes:
        mesh: a file; or a mesh as it is: an object of trimesh, pyvista, Open3D or
            meshio, or a pair (vertices, triangles) of arrays
        shape: "plane", "box", "sphere", "capsule", "limb", "funnel" or "statue"
        animation: of a mesh that has several, the name of the one that is
            played; False: none
        frames: mesh files of an obstacle that deforms
        bend: of a limb, how far it is bent at some times
        extent, radius, length, throat, height: of the shape, m; detail:
            segments around it
        up: [3] direction of the mesh that becomes +y; size: its largest
            dimension, m, or scale: a factor; stand: whether it is set on y = 0
        axis, angle: [3] and degrees, by which it is then turned; at: [3] m
        friction: Coulomb coefficient
        apart: m of room that its parts make where they press on each other
        motion: name of the motion that it follows
        vertices: [n, 3] m, where they are in the scene, with triangles: [k, 3]
            their numbers, instead of `mesh` and its placement
        vertex_frames: [f, n, 3] m, of an obstacle that deforms, instead of
            `vertices`, every frame_dt s, or at frame_times: [f] s, ascending;
            between: frames, "linear" or "cubic"
        sequence: of an obstacle that deforms, instead of `vertex_frames`: a file
            of USD, Alembic, .npz or glTF whose meshes move, or one of these as
            `read_meshes` returns it, with their triangles and times; a point
            cache (.pc2) of its `mesh`; or vertex_frames themselves
    """

    name: str | None = None
    mesh: str | os.PathLike[str] | Any | None = None
    shape: str | None = None
    frames: Frames | None = None
    bend: Sequence[Bend] | None = None
    extent: Vector | None = None
    radius: float | None = None
    length: float | None = None
    throat: float | None = None
    height: float | None = None
    detail: int | None = None
    up: Vector | None = None
    size: float | None = None
    scale: float | None = None
    stand: bool | None = None
    axis: Vector | None = None
    angle: float | None = None
    at: Vector | None = None
    friction: float | None = None
    apart: float | None = None
    motion: str | None = None
    look: Look | None = None
    animation: str | bool | None = None
    vertices: ArrayLike | None = None
    triangles: ArrayLike | None = None
    vertex_frames: ArrayLike | None = None
    frame_dt: float | None = None
    frame_times: ArrayLike | None = None
    between: str | None = None
    sequence: str | os.PathLike[str] | Any | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class Scene(Keys):
    """A scene: bodies, forces, and how a step is computed.

    Attributes:
        name: of the run
        cloths, garments, obstacles, motions: the bodies, and the motions that they
            name
        wind: default: there is no air
        camera: of pictures; default: one that sees all
        memory: GB that the library may hold
        frames, steps_per_frame: of a run
        backend: "ref", the CPU, or "gpu"
        precision: bits of a number in the state, 32 or 64
        threads: of the CPU, 0: as many as cores; block: of a block on a GPU
        dt: s a step
        gravity: [3] m/s²
        integrator: "baraff-witkin", "choi-ko", "bdf2", or an explicit one:
            "euler", "midpoint", "verlet", "rk4"; max_substeps: of these at most
        precond: "multigrid" or "jacobi"; matrix: "compact" or "cdf"; solver:
            "exact" or "cublas"
        tolerance: of a linear solve, relative; max_iterations: of it at most
        newton: linear solves of a cloth's motion in a step at most, 0: by the
            integrator
        self_collision: whether cloth meets cloth
        response: of contacts with an implicit integrator: "solve" or "impulses"
        max_rounds: of collision impulses; max_slices: into which a step is cut
        allow_intersecting: whether a start may intersect
        sleep: whether a scene at rest is skipped
    """

    name: str | None = None
    cloths: Sequence[Cloth] | None = None
    garments: Sequence[Garment] | None = None
    obstacles: Sequence[Obstacle] | None = None
    motions: Sequence[Motion] | None = None
    wind: Wind | None = None
    camera: Camera | None = None
    memory: float | None = None
    frames: int | None = None
    steps_per_frame: int | None = None
    backend: str | None = None
    precision: int | None = None
    threads: int | None = None
    block: int | None = None
    dt: float | None = None
    gravity: Vector | None = None
    integrator: str | None = None
    max_substeps: int | None = None
    precond: str | None = None
    matrix: str | None = None
    solver: str | None = None
    tolerance: float | None = None
    max_iterations: int | None = None
    newton: int | None = None
    self_collision: bool | None = None
    response: str | None = None
    max_rounds: int | None = None
    max_slices: int | None = None
    allow_intersecting: bool | None = None
    sleep: bool | None = None

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Scene:
        """Reads a scene's file as objects, whose keys can then be changed. Paths of
        meshes and patterns, which begin in the file's folder, become whole ones.

        Raises:
            SceneError: the file is refused; the text says what and where
        """
        from ._define import read_scene, tree_of

        text = _file(path)
        tree = tree_of(text)
        name_wholly(tree, os.path.dirname(os.path.abspath(text.file)))
        made: Scene = _objects(tree, Scene)
        for body in _only(made.cloths, Cloth):
            for name in CLOTH_ARRAYS:
                if isinstance(file := getattr(body, name), str):
                    setattr(body, name, _npy(file))
        read_scene(dataclasses.replace(read(made), file=text.file))
        return made

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene as a file, which `World` and the tool take, and which
        appears complete or not at all. Paths of meshes begin in its folder, which
        must be there.

        Arrays go into files beside it, whose names begin as its own: obstacles of
        arrays as PLY, `positions` and `velocities` of cloths as NumPy's, which
        `World` takes and the tool refuses.
        """
        put(read(self), path)


def put(made: Text, path: str | os.PathLike[str]) -> None:
    """Writes a scene as a file, and its arrays into files beside it."""
    tree = json.loads(made.text)
    file = Path(path)
    _whole.need_folder(file)
    for k, arrays in enumerate(made.cloths):
        for name, value in arrays.items():
            beside = file.with_name(f"{file.stem}.cloth{k}.{name}.npy")
            with _whole.beside(beside) as part:
                where = f"cloths[{k}].{name}"
                np.save(part, array(value, (None, 3), where), allow_pickle=False)
            tree["cloths"][k][name] = beside.name
    for k, arrays in enumerate(made.obstacles):
        if arrays:
            del tree["obstacles"][k]["shape"]
            name = f"{file.stem}.obstacle{k}"
            tree["obstacles"][k] |= _put_mesh(file.parent, name, arrays, k)
    text = json.dumps(tree, indent=2, ensure_ascii=False)
    _whole.write(path, (text + "\n").encode())


# The keys of bodies that name files, by the lists that the bodies are in.
FILES = {
    "cloths": ("panel.pattern", "positions", "velocities"),
    "garments": ("pattern", "sewn"),
    "obstacles": ("mesh", "frames.files", "frames.file", "sequence"),
}


def name_wholly(tree: dict[str, Any], folder: str) -> None:
    """Names a scene's files, which begin in this folder, by their whole paths. A mesh
    that is not there is looked for elsewhere by the scenes' reader."""
    for kind, names in FILES.items():
        for body in _bodies(tree, kind):
            for name in names:
                inner, _, last = name.rpartition(".")
                keys = body.get(inner) if inner and isinstance(body, dict) else body
                if isinstance(keys, dict) and isinstance(keys.get(last), str):
                    there = os.path.join(folder, keys[last])
                    if last != "mesh" or os.path.exists(there):
                        keys[last] = there


def _objects(tree: Any, kind: type[Any]) -> Any:
    """Returns an object of a class for a mapping of its keys, with objects in it;
    what is no mapping is returned as it is, for the reader to refuse."""
    if isinstance(tree, list):
        return [_objects(each, kind) for each in tree]
    if not isinstance(tree, Mapping):
        return tree
    inner = INSIDE.get(kind, {})
    keys = {
        key: _objects(value, inner[key]) if key in inner else value
        for key, value in tree.items()
    }
    try:
        return kind(**keys)
    except TypeError as error:
        raise SceneError(str(error)) from None


def _only(bodies: Any, kind: type[T]) -> list[T]:
    """Returns the objects of a class in what may be no list of them."""
    found = bodies if isinstance(bodies, list) else []
    return [each for each in found if isinstance(each, kind)]


def _npy(path: str) -> NDArray[Any]:
    """Returns the array of a file of NumPy's."""
    try:
        found = np.load(path, allow_pickle=False)
    except (OSError, ValueError) as error:
        raise SceneError(f"{path}: expected an array of NumPy's: {error}") from None
    if not isinstance(found, np.ndarray):
        raise SceneError(f"{path}: expected one array, a file .npy")
    return found


def _put_mesh(folder: Path, name: str, arrays: Arrays, k: int) -> dict[str, Any]:
    """Writes an obstacle's arrays as PLY; returns the keys that name the files."""
    where = f"obstacles[{k}]"
    if "triangles" not in arrays:
        raise SceneError(f"{where}: its arrays lack triangles")
    tri = array(arrays["triangles"], (None, 3), f"{where}.triangles", kind=np.int32)
    if "vertices" in arrays:
        x = array(arrays["vertices"], (None, 3), f"{where}.vertices")
        _whole.write(folder / f"{name}.ply", _meshes.ply(x, tri))
        return {"mesh": f"{name}.ply"}
    frames = array(
        arrays.get("vertex_frames"), (None, None, 3), f"{where}.vertex_frames"
    )
    for at, x in enumerate(frames):
        _whole.write(folder / f"{name}_{at:04d}.ply", _meshes.ply(x, tri))
    series: dict[str, Any] = {"files": f"{name}_%04d.ply", "first": 0}
    series["count"] = len(frames)
    if "frame_times" in arrays:
        series["times"] = times(arrays, len(frames), where).tolist()
    else:
        series["dt"] = float(arrays.get("frame_dt", 1 / 60))
    if "between" in arrays:
        series["between"] = str(arrays["between"])
    return {"frames": series}


# The classes of a class's keys that are objects, or lists of objects.
INSIDE: dict[type[Any], dict[str, type[Any]]] = {
    Motion: {"keys": Key},
    Cloth: {
        **{"start": Start, "material": Material, "holes": Region, "cuts": Region},
        **{"pins": Pin, "look": Look, "panel": Panel},
    },
    Garment: {"material": Material, "attach": Attach, "look": Look},
    Obstacle: {"frames": Frames, "bend": Bend, "look": Look},
    Scene: {
        **{"cloths": Cloth, "garments": Garment, "obstacles": Obstacle},
        **{"motions": Motion},
        **{"wind": Wind, "camera": Camera},
    },
}

CLOTH_ARRAYS = ("positions", "velocities")
# What is in a scene's file if it may have what the tool's reader does not know.
BEYOND_THE_TOOL = ('"positions"', '"velocities"', '"sequence"', *PYTHONS)
# What says when the frames of an obstacle are, and how it goes between them.
FRAME_TIMES = ("frame_dt", "frame_times", "between")
OBSTACLE_ARRAYS = ("vertices", "triangles", "vertex_frames", *FRAME_TIMES)
BETWEEN = ("linear", "cubic")  # by enum drape_between
# What a scene's file may say of an obstacle whose mesh is given by arrays.
OBSTACLE_KEYS = ("name", "friction", "motion", "look")


def as_dict(value: Any) -> Any:
    """Returns a scene's object as the mappings and lists of its keys; arrays
    stay as they are."""
    if isinstance(value, Keys):
        names = [f.name for f in dataclasses.fields(value)]  # type: ignore[arg-type]
        pairs = ((name, getattr(value, name)) for name in names)
        return {key: as_dict(item) for key, item in pairs if item is not None}
    if isinstance(value, Mapping):
        return {key: as_dict(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_dict(item) for item in value]
    return value


def mapping(value: Any, where: str, wanted: str) -> Mapping[str, Any]:
    """Returns the keys of a scene's object or of a mapping."""
    found = as_dict(value)
    if not isinstance(found, Mapping):
        raise SceneError(f"{where}: expected {wanted}, not {reprlib.repr(value)}")
    return found


def number(value: Any, where: str) -> float:
    """Returns one number."""
    return float(array(value, (), where))


def whole(value: Any, where: str) -> int:
    """Returns a whole number; a TypeError that names `where` if it is none."""
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(
            f"{where}: {reprlib.repr(value)}: expected a whole number"
        ) from None


def _plain(value: Any) -> Any:
    """What JSON is not able to hold: NumPy's numbers and arrays, and paths."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise SceneError(f"a scene holds numbers, texts and lists, not {value!r}")


Arrays = dict[str, Any]


@dataclass
class Text:
    """A scene as its reader takes it.

    Attributes:
        text: JSON
        file: what messages call it; paths begin in its folder
        cloths, obstacles: the arrays of each body, which the text lacks
    """

    text: str
    file: str
    cloths: list[Arrays]
    obstacles: list[Arrays]


# A scene in any form: an object, a mapping of its keys, the path of its file, or
# what `read` has made of one of these.
SceneLike = Scene | Mapping[str, Any] | str | os.PathLike[str] | Text


def _take(body: Any, names: Sequence[str]) -> Arrays:
    """Takes the arrays out of a body's mapping."""
    if not isinstance(body, dict):
        return {}
    return {name: body.pop(name) for name in names if body.get(name) is not None}


# Arrays of a cloth, and the keys that they take the place of.
INSTEAD = {"positions": "start", "velocities": "velocity"}


def _take_cloth(k: int, body: Any) -> Arrays:
    """Takes a cloth's arrays."""
    arrays = _take(body, CLOTH_ARRAYS)
    for name in arrays:
        if body.get(INSTEAD[name]) is not None:
            raise SceneError(
                f"cloths[{k}]: {INSTEAD[name]}: it has {name}, beside which this "
                "would have no effect"
            )
    return arrays


def _take_sequence(
    body: dict[str, Any], arrays: Arrays, folder: str, where: str
) -> None:
    """Puts in the place of an obstacle's sequence what it stands for: arrays, or of
    a point cache the keys of the tool's reader."""
    from .meshes import Mesh, merged, read_meshes

    sequence = body.pop("sequence")
    for key in ("vertices", "vertex_frames", "frames"):
        if key in arrays or body.get(key) is not None:
            raise SceneError(f"{where}: it has {key}, too")
    if not isinstance(sequence, (str, os.PathLike, Mesh)):
        arrays["vertex_frames"] = sequence
        return
    if not isinstance(sequence, Mesh) and str(sequence).lower().endswith(".pc2"):
        if body.get("mesh") is None:
            raise SceneError(f"{where}: expected the mesh that the point cache moves")
        keys = dict(zip(FRAME_TIMES, ("dt", "times", "between"), strict=True))
        given = {keys[name]: arrays.pop(name) for name in FRAME_TIMES if name in arrays}
        body["frames"] = {"file": os.fspath(sequence), **given}
        return
    for key in ("mesh", "triangles"):
        if key in arrays or body.get(key) is not None:
            raise SceneError(f"{where}: it has triangles, and so has {key}")
    meshes = (
        {sequence.name: sequence}
        if isinstance(sequence, Mesh)
        else read_meshes(os.path.join(folder, sequence))
    )
    found = merged(meshes, where)
    if "vertex_frames" not in found:
        raise SceneError(f"{where}: none of its meshes moves")
    if "frame_times" in arrays:
        del found["frame_dt"]
    arrays.update({**found, **arrays})


def _take_obstacle(k: int, body: Any, folder: str) -> Arrays:
    """Takes an obstacle's arrays; the reader gets a plane in their place, which
    the world's definition never sees."""
    from .meshes import Mesh, merged, read_meshes

    arrays = _take(body, OBSTACLE_ARRAYS)
    if isinstance(body, dict) and body.get("sequence") is not None:
        _take_sequence(body, arrays, folder, f"obstacles[{k}].sequence")
    mesh = body.get("mesh") if isinstance(body, dict) else None
    path = isinstance(mesh, (str, os.PathLike))
    if mesh is not None and (not path or str(mesh).lower().endswith(PYTHONS)):
        where = f"obstacles[{k}].mesh"
        if arrays:
            raise SceneError(f"{where}: it has vertices, and so has {min(arrays)}")
        if path:
            arrays = merged(read_meshes(os.path.join(folder, mesh)), where)
        elif isinstance(mesh, Mesh):
            arrays = merged({mesh.name: mesh}, where)
        else:
            arrays["vertices"], arrays["triangles"] = _meshes.mesh_of(mesh, where)
        del body["mesh"]
    if arrays:
        for key in sorted(set(body) - set(OBSTACLE_KEYS)):
            raise SceneError(
                f"obstacles[{k}]: {key}: an obstacle of arrays has no such key, "
                "as its vertices are where the scene has them"
            )
        body["shape"] = "plane"
    return arrays


def read(scene: SceneLike, folder: str | os.PathLike[str] | None = None) -> Text:
    """Returns a scene in the form that its reader takes.

    Args:
        scene: an object, a mapping, or the path of a file
        folder: where the paths of an object's meshes begin; default: here
    """
    if folder is not None and isinstance(scene, (Text, str, os.PathLike)):
        raise SceneError(
            f"folder: {os.fspath(folder)}: the paths of a file's meshes begin in the "
            "file's own folder"
        )
    if isinstance(scene, Text):
        return scene
    if isinstance(scene, (str, os.PathLike)):
        text = _file(scene)
        if not any(word in text.text for word in BEYOND_THE_TOOL):
            return text
        return dataclasses.replace(read(Scene.load(scene)), file=text.file)
    tree = as_dict(scene)
    if not isinstance(tree, dict):
        raise SceneError(f"expected a scene, a mapping or a path, not {scene!r}")
    cloths = [_take_cloth(k, body) for k, body in enumerate(_bodies(tree, "cloths"))]
    obstacles = [
        _take_obstacle(k, body, os.fspath(folder or ""))
        for k, body in enumerate(_bodies(tree, "obstacles"))
    ]
    file = os.path.join(folder, "scene") if folder else "scene"
    return Text(as_text(tree, "scene"), file, cloths, obstacles)


def _file(path: str | os.PathLike[str]) -> Text:
    """Returns the text of a scene's file."""
    file = os.fspath(path)
    try:  # the reader says what is wrong with bytes that are not UTF-8
        text = Path(file).read_text(encoding="utf-8", errors="surrogateescape")
    except OSError as error:
        raise SceneError(f"{file}: {error.strerror}") from error
    return Text(text, file, [], [])


def as_text(tree: Any, file: str) -> str:
    """Returns a scene's keys as JSON; a SceneError, which calls the scene `file`,
    where one of them has a value that JSON is not able to hold."""
    try:
        return json.dumps(tree, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        where = _not_finite(tree, "$")
        what = f"{where}: the number is not finite" if where else str(error)
        raise SceneError(f"{file}: {what}") from error


def _not_finite(value: Any, path: str) -> str | None:
    """Returns the path of the first number that is not finite; None: all are."""
    if isinstance(value, dict):
        inner = ((f"{path}.{key}", item) for key, item in value.items())
    elif isinstance(value, (list, tuple, np.ndarray)):
        inner = ((f"{path}[{k}]", item) for k, item in enumerate(value))
    else:
        wrong = isinstance(value, (float, np.floating)) and not np.isfinite(value)
        return path if wrong else None
    found = (_not_finite(item, at) for at, item in inner)
    return next(filter(None, found), None)


def _bodies(tree: dict[str, Any], key: str) -> list[Any]:
    """Returns a scene's list of bodies; what is none is left to the reader."""
    bodies = tree.get(key)
    return bodies if isinstance(bodies, list) else []


def times(arrays: Arrays, frames: int, where: str) -> NDArray[Any]:
    """Returns the times of an obstacle's frames, s."""
    if "frame_dt" in arrays:
        raise SceneError(f"{where}: frame_dt: it has frame_times")
    made = array(arrays["frame_times"], (None,), f"{where}.frame_times")
    if len(made) != frames:
        raise SceneError(f"{where}.frame_times: {len(made)} times of {frames} frames")
    return made


def array(
    value: Any, shape: tuple[int | None, ...], where: str, kind: Any = np.float64
) -> NDArray[Any]:
    """Returns a C-contiguous array of this shape, where None is any number. The
    value is any array that NumPy, torch, CuPy or Warp has.

    Raises SceneError that names `where`, the shape that it has and the one that
    was expected."""
    try:
        found = _meshes.on_host(value)
        if kind is not np.float64 and found.dtype.kind not in "iu":
            raise TypeError("expected whole numbers")
        if found.dtype.kind not in "iuf":
            raise TypeError("expected numbers")
        made = np.ascontiguousarray(found, dtype=kind).reshape(found.shape)
    except (TypeError, ValueError) as error:
        raise SceneError(f"{where}: {error}") from error
    fits = found.ndim == len(shape) and all(
        want in (None, have) for want, have in zip(shape, found.shape, strict=True)
    )
    if not fits or (found.size and found.dtype.kind != "f" and (made != found).any()):
        wanted = " × ".join("n" if want is None else str(want) for want in shape)
        wanted = f"{wanted} numbers in range" if shape else "one number"
        have = " × ".join(map(str, found.shape)) or "one number"
        raise SceneError(f"{where}: {have}; expected {wanted}")
    return made
