# SPDX-License-Identifier: Apache-2.0
"""Garments of sewing patterns, sewn by the tool: `drape sew` owns the law
(app/patterns/README.md §11), and this module asks it and reads what it wrote."""

from __future__ import annotations

import dataclasses
import functools
import json
import operator
import os
import tempfile
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import scene as scenes
from . import tool
from ._define import tree_of, with_keys
from .errors import DivergedError, SceneError, warn
from .export.run import Run, numbered, read_ply
from .reports import Outcome
from .uvmesh import CELL, UVMesh
from .world import NOT_CLEAN, World

SCENE = "scene.json"  # what is sewn, in its folder


@dataclass(frozen=True)
class Seam:
    """A seam as sewing left it.

    Attributes:
        name: the edges that it joins, as "front 1 to back 7"
        stage: in which its turn comes: "darts", "around", "seams" or "across"
        points: particles that it holds
        gap: m, the largest; gap_cells: as a part of a cell
        pull: N/m, the largest
        waiting: points that pull as hard as they may
        closed: the step after which all gaps were below 1 % of a cell; None: it is
            open
    """

    name: str
    stage: str
    points: int
    gap: float
    gap_cells: float
    pull: float
    waiting: int
    closed: int | None


@dataclass(frozen=True)
class Attachment:
    """Edges of a panel that were held once the garment was worn.

    Attributes:
        name: the panel and the label of its edges, as "front lower_interface"
        body: the name of the obstacle beside which they were held; None: the world, or
            it never held
        hold: "soft" or "hard"
        points: particles that it holds
        began, ended: the steps before it held and before it was let go; None: it was
            not yet
        slip: m, the largest way of a particle from where it is held
        pull: N/m, the largest
    """

    name: str
    body: str | None
    hold: str
    points: int
    began: int | None
    ended: int | None
    slip: float
    pull: float


@dataclass(frozen=True)
class SewnFrame:
    """A frame of sewing.

    Attributes:
        frame, step: its number, and the steps before it
        stage: "darts", "around", "seams", "across", "free", "worn" or "moving"
        gap_cells: the largest gap as a part of a cell, of the seams whose turn has
            come; seam: which has it; open: how many are; waiting: their points that
            pull as hard as they may
        pairs: of triangles that intersect; sewn_pairs: those that a seam joins, which
            cross by its gap and do not count as intersecting
    """

    frame: int
    step: int
    stage: str
    gap_cells: float
    seam: str | None
    open: int
    waiting: int
    pairs: int
    sewn_pairs: int


class Sewn:
    """Garments that `sew` has sewn, in a folder.

    Attributes:
        folder: has what `drape sew` writes (app/patterns/README.md §11); one that
            `sew` has chosen goes with this object
        end: "at rest", or "complete": all frames were made before, or bodies moved
        steps: of dt s each
        dt: s
        outcome: all that happened in any of the steps
        stages: the step before which each stage began
        seams: a `Seam` each, in the order of the garments and of their stitches
        attachments: an `Attachment` each, of a panel and a label
        frames: a `SewnFrame` each
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """Reads a folder that `sew` or ``drape sew`` has written."""
        self.folder = folder = Path(folder)
        if not (folder / "sew.json").exists():
            raise SceneError(f"{folder}: no garment was sewn in this folder")
        about = json.loads((folder / "sew.json").read_text(encoding="utf-8"))
        run = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        self.end: str = run["end"]
        self.steps: int = about["steps"]
        self.dt: float = about["dt"]
        self.stages: dict[str, int] = about["stages"]
        self.seams = [_seam(each) for each in about["seams"]]
        self.attachments = [_attachment(each) for each in about.get("attachments", [])]
        self.frames = [SewnFrame(**each) for each in about["frames"]]
        count = run["summary"]["outcomes"]
        flags = (flag for flag in Outcome if count[str(flag.name).lower()])
        self.outcome = functools.reduce(operator.or_, flags, Outcome(0))

    def __repr__(self) -> str:
        """How many seams are closed, and how it ended."""
        closed = len(self.seams) - len(self.open)
        return (
            f"<drape.Sewn: {closed} of {len(self.seams)} seams closed, "
            f"{self.steps} steps, {self.end}, {self.folder}>"
        )

    @property
    def open(self) -> list[Seam]:
        """The seams that are not closed."""
        return [seam for seam in self.seams if seam.closed is None]

    @property
    def clean(self) -> bool:
        """Whether nothing went through anything: no step is trapped, passed or
        diverged, and no frame has pairs that intersect."""
        return not self.outcome & NOT_CLEAN and not any(f.pairs for f in self.frames)

    @functools.cached_property
    def positions(self) -> NDArray[np.floating[Any]]:
        """[n, 3] m, the particles of all garments as they are sewn, before bodies
        move, in the order of the garments and of their panels."""
        return np.concatenate(self._sewn)

    @functools.cached_property
    def _sewn(self) -> list[NDArray[np.floating[Any]]]:
        """The particles of each garment at the end."""
        return [read_ply(file)[0] for file in sorted(self.folder.glob("sewn_*.ply"))]

    @functools.cached_property
    def meshes(self) -> list[UVMesh | None]:
        """Of each garment the mesh that it was made of; None: it is of a pattern."""
        found = []
        for garment in self._garments:
            file = os.path.join(self.folder, garment["pattern"])
            found.append(UVMesh.of_pattern(file))
        return found

    @functools.cached_property
    def _garments(self) -> list[dict[str, Any]]:
        text = (self.folder / "sewn.json").read_text(encoding="utf-8")
        garments: list[dict[str, Any]] = json.loads(text)["garments"]
        return garments

    def vertices(self, frame: int | None = None, garment: int = 0) -> NDArray[Any]:
        """Returns where the cloth carries the vertices of a garment's mesh, [n, 3] m.

        Args:
            frame: of those that were written; default: as `positions` has it, sewn,
                before bodies move
            garment: its number
        """
        meshes = self.meshes
        mesh = meshes[garment] if garment < len(meshes) else None
        if mesh is None:
            raise SceneError(f"{self.folder}: garment {garment} is of no mesh")
        counts = [len(each) for each in self._sewn]
        if frame is None:
            x = self._sewn[garment]
        else:  # garments are the last of the cloths
            all_ = self.run.particles(frame)
            first = len(all_) - sum(counts[garment:])
            x = all_[first : first + counts[garment]]
        return mesh.carried(x, self._garments[garment].get("cell", CELL))

    def save_mesh(self, path: str | os.PathLike[str], garment: int = 0) -> int:
        """Writes the mesh of a garment where the cloth carries it, as OBJ with the
        faces and the UVs that it had, and returns the number of files.

        Args:
            path: of the mesh as it is sewn, before bodies move; or, with a place for a
                number, as dress_%04d.obj, of a mesh for each frame that was written
            garment: its number
        """
        file = Path(path)
        frames: list[int | None] = [None]
        if "%" in file.name:
            numbered(file)
            frames = list(self.run.frames())
        for frame in frames:
            x, mesh = self.vertices(frame, garment), self.meshes[garment]
            assert mesh
            name = file.name if frame is None else file.name % frame
            mesh.save(file.with_name(name), x)
        return len(frames)

    @property
    def pictures(self) -> dict[str, Path]:
        """The pictures of the end, "front" and "back"."""
        found = sorted((self.folder / "pictures").glob("*_*.png"))
        sides = {file.stem.partition("_")[0]: file for file in found}
        return {side: sides[side] for side in ("front", "back") if side in sides}

    @property
    def scene(self) -> scenes.Scene:
        """A scene that begins as sewing ended, with bodies that move if they have
        motions or frames."""
        return scenes.Scene.load(self.folder / "sewn.json")

    @property
    def run(self) -> Run:
        """The frames, body by body."""
        return Run(self.folder)

    def world(self, **keys: Any) -> World:
        """Returns a world of `scene`, some of whose keys may be replaced."""
        return World(self.folder / "sewn.json", **keys)


def _seam(row: dict[str, Any]) -> Seam:
    """Returns a seam of sew.json, whose names have units."""
    gap, pull = row.pop("gap_m"), row.pop("pull_N_per_m")
    return Seam(gap=gap, pull=pull, **row)


def _attachment(row: dict[str, Any]) -> Attachment:
    """Returns an attachment of sew.json."""
    steps = {"began": row.pop("from"), "ended": row.pop("until")}
    slip, pull = row.pop("slip_m"), row.pop("pull_N_per_m")
    return Attachment(**steps, slip=slip, pull=pull, **row)


def sew(
    pattern: scenes.SceneLike | UVMesh,
    body: Any = None,
    *,
    motion: str | os.PathLike[str] | bool | None = None,
    rate: float = 60,
    cell: float | None = None,
    material: str | scenes.Material | Mapping[str, Any] | None = None,
    attach: Sequence[scenes.Attach | Mapping[str, Any]] | None = None,
    folder: str | os.PathLike[str] | None = None,
    frames: int | None = None,
    every: int = 1,
    pictures: bool = True,
    force: bool = False,
    log: Callable[[str], object] | None = None,
    **keys: Any,
) -> Sewn:
    """Sews the garment of a pattern on a body, and drapes it: what ``drape sew`` does.
    A seam that cannot close is not an error: it is in `Sewn.open`.

    Args:
        pattern: a file as GarmentCode writes it; a mesh whose UV charts are its panels,
            a `UVMesh` or an OBJ file in metres, which starts where it is; or a scene,
            as `World` takes it, with garments and obstacles, without `body`, `cell` and
            `material`
        body: that wears it: an `Obstacle` or a list of these; or a mesh: a file, or
            what an obstacle takes as `mesh`
        motion: how the body, a mesh, moves once it wears the garment: a point cache
            (.pc2) of its file, or numbered files of it with %d or %04d in the name;
            where its first frame is not the mesh, a second brings the body there.
            Bodies of a scene move as it says; False: they stay where they are at
            time 0
        rate: frames of `motion` a second
        cell: m, side of a cell; default: 0.005
        material: a fabric's name, a `Material` or a mapping; default: light cotton
        attach: which edges of a pattern are held once the garment is worn, by their
            labels: a list of `Attach`; default: those of the label "lower_interface" to
            which nothing is sewn
        folder: for what is written; default: one that goes with what is returned
        frames: at most, until the garment is at rest; default: the scene's, of a
            pattern 600
        every: of the frames, which are written
        pictures: whether some are taken from the front and from the back, when the
            garment is worn and when bodies have moved
        force: whether files of another run are removed from the folder
        log: called with each line that the tool says: its progress, every few seconds,
            and its notes, which are warnings otherwise
        keys: replace the scene's own: backend="gpu", threads=1, …

    Raises:
        SceneError: the pattern, the body or the scene is refused
        DivergedError: a step was given up; the folder has the state before it
        Error: the tool failed
    """
    given = {"body": body, "cell": cell, "material": material}
    given["motion"] = None if motion in (True, False, None) else (motion, rate)
    given["attach"] = attach
    mesh = _mesh_of(pattern)
    if mesh and attach is not None:
        raise SceneError("attach: it is for a pattern; edges of a mesh have no label")
    text = None if mesh else _read(_wrapped(pattern, given), keys)  # type: ignore[arg-type]
    words: list[object] = ["--every", every]
    words += [] if frames is None else ["--frames", frames]
    words += ["--no-motion"] if motion is False else []
    words += [] if pictures else ["--no-picture"]
    words += ["--force"] if force else []

    def work(folder: Path) -> Sewn:
        if text is not None:
            return _sew(text, folder, force, words, log)
        assert mesh
        _claim(folder, force)
        try:
            garment = mesh.garment(folder, cell=cell or CELL, material=material)
            scene = _worn(garment, mesh.file.stem, body, given["motion"])
            return _sew(_read(scene, keys), folder, force, words, log)
        finally:
            if not (folder / "sew.json").exists():
                for file in mesh.files(folder):
                    file.unlink(missing_ok=True)

    if folder is not None:
        return work(Path(folder))
    temporary = tempfile.TemporaryDirectory(prefix="drape-")
    try:
        made = work(Path(temporary.name))
    except BaseException:
        temporary.cleanup()
        raise
    weakref.finalize(made, temporary.cleanup)
    return made


def _sew(
    text: scenes.Text,
    folder: Path,
    force: bool,
    words: Sequence[object],
    log: Callable[[str], object] | None,
) -> Sewn:
    """Writes a scene into a folder, and has the tool sew it there."""
    _claim(folder, force)
    tree, file = tree_of(text), folder / SCENE
    scenes.name_wholly(tree, os.path.dirname(os.path.abspath(text.file)))
    text = dataclasses.replace(text, text=scenes.as_text(tree, text.file))
    scenes.put(text, file)
    last = ""

    def hear(line: str) -> None:
        nonlocal last
        last = line.replace(str(file), text.file)
        if log:
            log(last)
        elif "note: " in last and "come to rest" not in last:  # `end` says it
            warn(last)

    status = tool.follow("sew", file, "--out", folder, *words, log=hear)
    if status not in (0, 1) or not (folder / "sew.json").exists():
        file.unlink(missing_ok=True)  # so that the folder can be used again
        last = last.replace("--out", "folder").replace("--force", "force=True")
        raise tool.failure(status, last or f"exit status {status}")
    made = Sewn(folder)
    if made.end == "diverged":
        raise DivergedError(f"{text.file}: step {made.steps}: sewing diverged")
    return made


def _claim(folder: Path, force: bool) -> None:
    """Makes a folder, or refuses one in which garments were sewn, before their scene
    is written anew; what else a run leaves there the tool refuses."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("sew.json", SCENE):
        if force:
            (folder / name).unlink(missing_ok=True)
        elif (folder / name).exists():
            raise SceneError(
                f"{folder}: holds {name}; give another folder, or force=True to "
                "remove it"
            )


def _wrapped(pattern: scenes.SceneLike, given: Mapping[str, Any]) -> scenes.SceneLike:
    """Returns the scene of a pattern and a body; a scene as it is."""
    if not _is_pattern(pattern):
        for key, value in given.items():
            if value is not None:
                raise SceneError(f"{key}: it is for a pattern; a scene has its own")
        return pattern
    file = Path(pattern)  # type: ignore[arg-type]
    garment = scenes.Garment(
        pattern=file,
        cell=given["cell"],
        material=given["material"],
        attach=given["attach"],
    )
    return _worn(garment, file.stem, given["body"], given["motion"])


def _worn(garment: scenes.Garment, name: str, body: Any, motion: Any) -> scenes.Scene:
    """Returns the scene of a garment on a body."""
    return scenes.Scene(
        name=name, frames=600, garments=[garment], obstacles=_bodies(body, motion)
    )


def _read(scene: scenes.SceneLike, keys: Mapping[str, Any]) -> scenes.Text:
    """Returns what the tool sews."""
    text = with_keys(scenes.read(scene), keys)
    if any(text.cloths):
        raise SceneError(f"{text.file}: the tool that sews reads no arrays of cloths")
    return text


def _mesh_of(pattern: scenes.SceneLike | UVMesh) -> UVMesh | None:
    """Returns the mesh whose charts are to be sewn; None: it is something else."""
    if isinstance(pattern, UVMesh):
        return pattern
    path = isinstance(pattern, (str, os.PathLike)) and Path(pattern)
    return UVMesh(path) if path and path.suffix.lower() == ".obj" else None


def _is_pattern(pattern: scenes.SceneLike) -> bool:
    """Whether this is the path of a pattern, not a scene; a file that is neither is
    for the scenes' reader to refuse."""
    if not isinstance(pattern, (str, os.PathLike)):
        return False
    return isinstance(tree_of(scenes.read(pattern)).get("pattern"), dict)


def _bodies(body: Any, motion: Any) -> list[Any] | None:
    """Returns the obstacles of a body, of which a file's mesh may move."""
    kinds = scenes.Obstacle, Mapping
    if motion is not None:
        name, rate = os.fspath(motion[0]), motion[1]
        if not isinstance(body, (str, os.PathLike)):
            raise SceneError(
                "motion: expected a body, the file of a mesh, which it moves"
            )
        if not rate > 0:
            raise SceneError(f"rate: {rate}: expected frames a second, above 0")
        keys: dict[str, Any] = {"files" if "%" in name else "file": name}
        frames = scenes.Frames(**keys, dt=1 / rate, lead=1)
        return [scenes.Obstacle(name="body", mesh=body, frames=frames)]
    if body is None or isinstance(body, kinds):
        return body if body is None else [body]
    if isinstance(body, (list, tuple)) and all(isinstance(b, kinds) for b in body):
        return list(body)
    return [scenes.Obstacle(name="body", mesh=body)]
