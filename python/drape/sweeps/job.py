# SPDX-License-Identifier: Apache-2.0
"""Jobs of a sweep: a scene, how long it runs, and what is kept of it."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import io
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import scene as scenes
from .._core import ffi, lib
from .._define import read_scene, tree_of, with_keys
from .._meshes import on_host
from ..errors import Error, SceneError
from ..export.arrays import of_world
from ..sewing import Sewn, sew
from ..world import Reports, World

Data = dict[str, NDArray[Any]]
FORMAT = 2  # of results: those of another one are not taken for this one's


@dataclass
class Variant:
    """A scene of a sweep, and the parameters that made it.

    Attributes:
        scene: what `World` takes
        parameters: columns of the sweep's table
        label: for people, as "bend=1e-05, dt=0.01"; default: the scene's name
    """

    scene: scenes.SceneLike
    parameters: dict[str, Any] = field(default_factory=dict)
    label: str = ""


# A parameter's values: in a list; or by names, which labels and the table have.
Values = Sequence[Any] | Mapping[str, Any]


def grid(scene: scenes.SceneLike, axes: Mapping[str, Values]) -> list[Variant]:
    """Returns a scene's variants: all combinations of some parameters' values. The
    last words of their paths are in the labels.

    Args:
        scene: what `World` takes
        axes: values by the path of a key, as "dt", "cloths.0.material.bend" or
            "garments.0.pattern"; values of many words, as the "obstacles" of a
            body, are given names by a mapping
    """
    all_ = product(*map(_named, axes.values()))
    return _of_keys([_variant(scene, dict(zip(axes, e, strict=True))) for e in all_])


def _named(axis: Values) -> list[tuple[Any, Any]]:
    """Returns an axis's values, each behind its name, or itself."""
    if isinstance(axis, Mapping):
        return list(axis.items())
    return [(value, value) for value in axis]


Draw = Callable[[np.random.Generator], Any]


def sample(
    scene: scenes.SceneLike,
    axes: Mapping[str, Values | Draw],
    count: int,
    seed: int = 0,
) -> list[Variant]:
    """Returns variants of a scene whose parameters are drawn at random. Number k is
    the same for any count, and has its own column, `draw`, and the seed's.

    Args:
        scene: what `World` takes
        axes: by the path of a key: a pair (low, high) to draw from evenly, a list, or
            a mapping by names, to choose from, or a function of a
            `numpy.random.Generator`
        count: how many
        seed: a whole number, from which all numbers follow
    """
    variants = []
    for k in range(scenes.whole(count, "count")):
        generator = np.random.default_rng([scenes.whole(seed, "seed"), k])
        drawn = {path: _drawn(axis, generator) for path, axis in axes.items()}
        made = _variant(scene, drawn)
        made.parameters |= {"seed": seed, "draw": k}
        variants.append(made)
    return _of_keys(variants)


def _of_keys(variants: list[Variant]) -> list[Variant]:
    """Refuses variants by a key that scenes do not have: it is wrong in each of them,
    whatever its value, and is told once."""
    try:
        for each in variants[:1]:
            read_scene(scenes.read(each.scene), notes=False)
    except SceneError as error:
        if "unknown key" in str(error):
            raise
    return variants


def _drawn(axis: Values | Draw, generator: np.random.Generator) -> tuple[Any, Any]:
    """Returns a value behind its name, or itself."""
    if callable(axis):
        value = axis(generator)
    elif isinstance(axis, tuple):
        low, high = axis
        value = float(generator.uniform(low, high))
    else:
        name, value = _named(axis)[int(generator.integers(len(axis)))]
        if isinstance(axis, Mapping):
            return name, value
    return _plain(value), _plain(value)


def _plain(value: Any) -> Any:
    """Returns a value with plain numbers in place of NumPy's."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return [_plain(each) for each in value] if isinstance(value, list) else value


def _variant(scene: scenes.SceneLike, chosen: dict[str, tuple[Any, Any]]) -> Variant:
    """Returns a scene with the values of some keys' paths, of which each is behind
    its name."""
    tree = _tree(scene)
    for path, (_, value) in chosen.items():
        _put(tree, path, value)
    parameters = {path: name for path, (name, _) in chosen.items()}
    last = [path.rpartition(".")[2] for path in parameters]
    words = (
        f"{word if last.count(word) == 1 else path}={_told(value)}"
        for word, (path, value) in zip(last, parameters.items(), strict=True)
    )
    return Variant(tree, parameters, ", ".join(words))


def _told(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_told, value))}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _tree(scene: scenes.SceneLike) -> Any:
    """Returns a scene's keys, in containers that nobody else has. Those of a file
    have its arrays, and whole paths, as a variant is in no folder."""
    if isinstance(scene, scenes.Text):
        return tree_of(scene)
    if isinstance(scene, (str, os.PathLike)):
        scene = scenes.Scene.load(scene)
    return scenes.as_dict(scene)


def _put(tree: Any, path: str, value: Any) -> None:
    """Sets the key of a path; an object that is not there is made."""
    *way, last = path.split(".")
    try:
        for word in way:
            tree = tree[int(word)] if isinstance(tree, list) else _into(tree, word)
        if isinstance(tree, list):
            tree[int(last)] = value
        else:
            tree[last] = value
    except (IndexError, ValueError, TypeError) as error:
        raise SceneError(f"{path}: the scene has no such place") from error


def _into(tree: Any, word: str) -> Any:
    if isinstance(tree.get(word, {}), str):
        tree[word] = {"name": tree[word]}  # "material": "denim"
    return tree.setdefault(word, {})


@dataclass(frozen=True)
class Job:
    """A scene to run, as it goes to another process or machine.

    Attributes:
        name: of the scene in the sweep
        scene: as its reader takes it
        frames: to make; every: of which the positions are kept, 0: of none
        parameters: columns of the table
        label: for people
        sew: whether its garments are sewn before
    """

    name: str
    scene: scenes.Text
    frames: int | None
    every: int
    parameters: dict[str, Any]
    label: str = ""
    sew: bool = False

    @property
    def id(self) -> str:
        """Identifies what is computed: scene, frames, version and what is kept.
        Files of meshes and patterns are known by their paths, not by what is in
        them."""
        total = hashlib.sha256()
        text = self.scene.text
        about = [text, self.frames, self.every, version(), FORMAT]
        if any(f'"{key}"' in text for key in ("mesh", "files", "pattern")):
            about.append(self.scene.file)
        if self.sew:
            about.append("sewn")
        total.update(json.dumps(about).encode())
        for arrays in (*self.scene.cloths, *self.scene.obstacles):
            for key in sorted(arrays):
                array = np.ascontiguousarray(on_host(arrays[key]))
                total.update(f"{key} {array.dtype} {array.shape} ".encode())
                total.update(array.tobytes())
        return total.hexdigest()[:32]

    def plain(self) -> dict[str, Any]:
        """Returns what a worker needs of the job, as JSON holds it."""
        names = "name", "frames", "every", "sew"
        about: dict[str, Any] = {key: getattr(self, key) for key in names}
        about |= {"text": self.scene.text, "file": self.scene.file}
        for key in ("cloths", "obstacles"):
            about[key] = [
                {name: _packed(value) for name, value in arrays.items()}
                for arrays in getattr(self.scene, key)
            ]
        return about

    @staticmethod
    def of(about: Mapping[str, Any]) -> Job:
        """Returns the job that `plain` told, without its parameters."""
        cloths, obstacles = (
            [
                {str(name): _unpacked(value) for name, value in arrays.items()}
                for arrays in about[key]
            ]
            for key in ("cloths", "obstacles")
        )
        text = scenes.Text(str(about["text"]), str(about["file"]), cloths, obstacles)
        name, every = str(about["name"]), int(about["every"])
        return Job(name, text, about["frames"], every, {}, sew=bool(about["sew"]))


def _packed(value: Any) -> float | str:
    """Returns an array as a text, in the format of NumPy's files; a number as it
    is."""
    if isinstance(value, (int, float)):
        return value
    buffer = io.BytesIO()
    np.save(buffer, on_host(value), allow_pickle=False)
    return base64.b64encode(buffer.getvalue()).decode()


def _unpacked(value: Any) -> Any:
    """Returns the array of a text; a number as it is."""
    if isinstance(value, (int, float)):
        return value
    buffer = io.BytesIO(base64.b64decode(value, validate=True))
    return np.load(buffer, allow_pickle=False)


def version() -> str:
    """What the library says of itself: another one's results are others'."""
    return str(ffi.string(lib.drape_info()).decode().splitlines()[0])


def jobs_of(
    given: Mapping[str, Any] | Sequence[Any],
    keys: Mapping[str, Any],
    frames: int | None,
    every: int,
    sew: bool = False,
) -> Iterator[Job]:
    """Returns the jobs of scenes by names, or in a list, by their numbers."""
    if not isinstance(given, Mapping):
        given = {f"{k:06d}": each for k, each in enumerate(given)}
    for name, each in given.items():
        variant = each if isinstance(each, Variant) else Variant(each)
        text = with_keys(scenes.read(variant.scene), keys)
        # a worker may be started in another folder
        text = dataclasses.replace(text, file=os.path.abspath(text.file))
        label = variant.label or str(name)
        yield Job(str(name), text, frames, every, variant.parameters, label, sew)


def digest(data: Data) -> str:
    """Returns the SHA-256 of arrays: their names, types, shapes and bytes."""
    total = hashlib.sha256()
    for name in sorted(data):
        array = np.ascontiguousarray(data[name])
        total.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def run(job: Job) -> tuple[dict[str, Any], Data]:
    """Runs a job and returns its row of the table and its arrays: `positions`
    and `velocities` at the end; `frames` [count, vertices of cloths, 3], `frame_dt`
    s apart; and what `of_world` says of triangles, rest and bodies."""
    began = time.perf_counter()
    sewn = sew(job.scene, motion=False, pictures=False) if job.sew else None
    with sewn.world() if sewn else World(job.scene) as world:
        own = 0 if sewn else world.frames
        frames = own if job.frames is None else job.frames
        cloths = max(b.vertices.stop for b in world.bodies if b.kind == "cloth")
        reports, kept = Reports(), []
        for frame in range(frames + 1):
            if frame:
                reports += world.step(world.steps_per_frame)
            if job.every and frame % job.every == 0:
                kept.append(_state(world)[0][:cloths])
        x, v = _state(world)
        data = {"positions": x, "velocities": v, **of_world(world)}
        if kept:
            apart = job.every * world.steps_per_frame * world.dt
            data |= {"frames": np.stack(kept), "frame_dt": np.array(apart)}
        row = _row(world, reports)
    if sewn:
        row |= _sewn_row(sewn)
        if not reports:  # the audit of all pairs has those that seams join, too
            row["intersecting"] = sewn.frames[-1].pairs
    row["seconds"] = time.perf_counter() - began
    row["digest"] = digest(data)
    return row, data


def _state(world: World) -> tuple[NDArray[Any], NDArray[Any]]:
    kind = np.dtype(f"<f{world.precision // 8}")
    x, v = world.read()
    return x.astype(kind), v.astype(kind)


def _row(world: World, reports: Reports) -> dict[str, Any]:
    last = reports[-1] if reports else None
    names = [flag.name.lower() for flag in reports.outcome if flag.name]
    return {
        "scene": world.name,
        "vertices": len(world),
        "triangles": len(world.triangles),
        "steps": len(reports),
        "time": last.time if last else 0.0,
        "outcome": "+".join(names) or "clean",
        "clean": reports.clean,
        "intersecting": last.intersecting if last else world.audit().count,
        "most_contacts": max((r.contacts for r in reports), default=0),
        "most_rounds": max((r.rounds for r in reports), default=0),
        "kinetic": last.kinetic if last else None,
        "elastic": last.elastic if last else None,
        "potential": last.potential if last else None,
    }


def _sewn_row(sewn: Sewn) -> dict[str, Any]:
    """What a row has of sewing."""
    return {
        "sewn_end": sewn.end,
        "sewn_steps": sewn.steps,
        "sewn_clean": sewn.clean,
        "sewn_pairs": sum(each.pairs for each in sewn.frames),
        "seams": len(sewn.seams),
        "seams_open": len(sewn.open),
        "most_gap": max(each.gap for each in sewn.seams),
        "most_pull": max(each.pull for each in sewn.seams),
    }


@dataclass
class Answer:
    """What became of a job.

    Attributes:
        row, data: its result; None if it failed
        error: why it failed
        final: whether another attempt would fail likewise
    """

    row: dict[str, Any] | None = None
    data: Data | None = None
    error: str = ""
    final: bool = False


def attempt(job: Job) -> Answer:
    """Runs a job; a failure is an answer too."""
    try:
        return Answer(*run(job))
    except (SceneError, ArithmeticError) as error:
        return Answer(error=f"{type(error).__name__}: {error}", final=True)
    except (Error, OSError, MemoryError) as error:
        return Answer(error=f"{type(error).__name__}: {error}")
