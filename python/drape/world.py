# SPDX-License-Identifier: Apache-2.0
"""Worlds: scenes that were made, and their state."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import html
import os
import tempfile
import threading
import weakref
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, cast, overload

import numpy as np
from numpy.typing import NDArray

from . import scene as scenes
from ._closing import Closing
from ._core import ffi, lib
from ._define import Handle, with_keys
from ._library import Calls, Log, Trace
from ._signals import Held
from ._stretch import Stretch
from .arrays import SharedArray, address, order
from .bodies import Bodies
from .control import fault_of, told
from .errors import DivergedError, Error, SceneError, check, need, warn
from .mesh import Audit, audit
from .pins import Pinning, Pins
from .record import Recorder, picture
from .reports import PARTS, Memory, Outcome, PlanRow, StepReport, Work
from .saved import Saved

if TYPE_CHECKING:
    from .viewer.show import Viewer

NOT_CLEAN = Outcome.TRAPPED | Outcome.PASSED | Outcome.DIVERGED


def outcome_names(outcome: Outcome) -> str:
    """Returns the names of all that happened; empty if nothing did."""
    return "|".join(str(each.name) for each in Outcome if each & outcome)


class Reports(list[StepReport]):
    """The reports of some steps, in their order; and by a field's name, as
    ``reports["kinetic"]``, an array of its values."""

    @property
    def outcome(self) -> Outcome:
        """All that happened in any of the steps."""
        all_of_them = Outcome(0)
        for report in self:
            all_of_them |= report.outcome
        return all_of_them

    @property
    def clean(self) -> bool:
        """Whether no step is trapped, passed or diverged, so that nothing intersects
        at the end of any step, and nothing went through anything."""
        return not self.outcome & NOT_CLEAN

    @overload
    def __getitem__(self, key: SupportsIndex) -> StepReport: ...
    @overload
    def __getitem__(self, key: slice) -> Reports: ...
    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...

    def __getitem__(self, key: SupportsIndex | slice | str) -> Any:
        """A report, the reports of a slice, or a column of `columns`."""
        if isinstance(key, str):
            columns = self.columns()
            if key not in columns:
                raise KeyError(f"{key}: expected one of {', '.join(columns)}")
            return columns[key]
        return (
            Reports(super().__getitem__(key))
            if isinstance(key, slice)
            else (super().__getitem__(key))
        )

    def columns(self) -> dict[str, NDArray[Any]]:
        """Returns an array [steps] of each field by its name: those of `StepReport`,
        and of its parts, as "seconds.solver" and "work.near"."""
        names = [field.name for field in dataclasses.fields(StepReport)]
        plain = {
            name: np.array([getattr(each, name) for each in self])
            for name in names
            if name not in ("seconds", "work")
        }
        seconds = {
            f"seconds.{part}": np.array([each.seconds[part] for each in self])
            for part in PARTS
        }
        work = {
            f"work.{field.name}": np.array(
                [getattr(each.work, field.name) for each in self]
            )
            for field in dataclasses.fields(Work)
        }
        return plain | seconds | work

    def to_pandas(self) -> Any:
        """Returns the columns as a data frame of pandas, a row a step."""
        return need("pandas", "to_pandas", "pandas").DataFrame(self.columns())

    def __repr__(self) -> str:
        """How many there are, and all that happened in any of the steps."""
        names = outcome_names(self.outcome)
        clean = "clean" if self.clean else "not clean"
        return f"<drape.Reports: {len(self)} steps, {clean}{names and f': {names}'}>"


def _undiverged(report: StepReport) -> StepReport:
    """Returns a report of a step that was done; raises if it was given up."""
    if report.outcome & Outcome.DIVERGED:
        raise DivergedError(
            f"step {report.step + 1}: diverged; the state before it is kept"
        )
    return report


def _plain(c: Any) -> dict[str, Any]:
    """Returns the numbers of a struct by the names of its fields."""
    kind = ffi.typeof(c)
    struct = kind.item if kind.kind == "pointer" else kind
    return {name: getattr(c, name) for name, _ in struct.fields}


def step_report(c: Any) -> StepReport:
    """Returns a drape_step_report."""
    fields = _plain(c)
    fields["outcome"] = Outcome(c.outcome)
    fields["seconds"] = dict(zip(PARTS, c.seconds, strict=True))
    fields["work"] = Work(**_plain(c.work))
    return StepReport(**fields)


def _plain_wind(c: Any) -> dict[str, Any]:
    """Returns a drape_wind as a scene has it."""
    return {**_plain(c), "velocity": list(c.velocity)}


class World(Pinning, Bodies, Saved, Closing):
    """A scene that was made, and its state, which `step` advances.

    Calls on one world from several threads follow one another; worlds are
    independent, and threads that step different worlds run side by side. No
    thread changes a bit of any of them.
    """

    def __init__(
        self,
        scene: scenes.SceneLike,
        *,
        folder: str | os.PathLike[str] | None = None,
        log: Log | None = None,
        trace: Trace | None = None,
        **keys: Any,
    ) -> None:
        """Reads a scene, checks the whole of it, and makes the world, at time 0.

        Args:
            scene: a `Scene`, a mapping of a scene's keys, or its file's path
            folder: where the paths of meshes of a scene without file begin
            log: called with lines for people: what was made, and why not
            trace: called after each stage of a step with the steps done, the
                stage's name, a 64-bit digest of its output, and seconds
            keys: replace the scene's own: backend="gpu", precision=64, …

        Raises:
            SceneError: the scene is refused; the text says what and where
            OutOfMemoryError, DeviceError: what the text says is lacking
        """
        text = with_keys(scenes.read(scene, folder), keys)
        self._text = scenes.Text(text.text, text.file, [], [])
        self._calls = Calls(log, trace)
        self._mirrors: dict[str, weakref.ref[NDArray[Any]]] = {}
        self._recorder: Recorder | None = None
        self._report: StepReport | None = None
        self._reports = Reports()
        self._stretch = Stretch()
        self._groups: dict[str, Pins] = {}
        self._told: set[int] = set()  # cloths whose pins are not the scene's any more
        self._now = (0, 0.0)  # what the clock was after the last call
        self._handle: Handle | None = Handle(text, self._calls)
        self._calls.raise_kept()
        self._triangles = self._read_triangles()
        self.bodies = tuple(self._read_bodies())

    # What the world is

    def _open(self) -> Handle:
        if self._handle is None:
            raise Error("the world is closed")
        return self._handle

    @property
    def _world(self) -> Any:
        return self._open().world

    @property
    def _guard(self) -> threading.RLock:
        return self._open().lock

    @property
    def name(self) -> str:
        """The scene's name."""
        return str(ffi.string(self._open().scene.name).decode(errors="replace"))

    @property
    def frames(self) -> int:
        """Frames that a run of the scene makes."""
        return int(self._open().scene.frames)

    @property
    def steps_per_frame(self) -> int:
        """Steps between two frames of a run."""
        return int(self._open().scene.steps_per_frame)

    @property
    def dt(self) -> float:
        """Length of a step, s."""
        return float(self._open().definition.dt)

    @property
    def precision(self) -> int:
        """Bits of a number in the state, 32 or 64."""
        return int(self._open().definition.precision)

    @property
    def backend(self) -> str:
        """Where steps are computed, "ref" or "gpu"."""
        return "gpu" if self._open().definition.backend == lib.DRAPE_GPU else "ref"

    @property
    def steps(self) -> int:
        """Steps done since time 0, those before a checkpoint or log too."""
        return self._now[0]

    @property
    def time(self) -> float:
        """Time of the state, s."""
        return self._now[1]

    def _clock(self) -> tuple[int, float]:
        """Returns what the library's clock says; the caller has the guard."""
        step, time = ffi.new("int64_t *"), ffi.new("double *")
        check(lib.drape_clock(self._world, step, time), "clock")
        return step[0], time[0]

    @property
    def report(self) -> StepReport | None:
        """The report of the last step; None before the first one, and before the
        first one after a checkpoint was loaded."""
        return self._report

    @property
    def reports(self) -> Reports:
        """The reports of the last call that made steps, as far as it came: those
        of `step` where Ctrl-C or an exception has ended it, too. The last one is
        of a step that was given up where the call has raised a DivergedError."""
        return self._reports

    # Steps

    def _begin(self) -> None:
        """Begins a call that makes steps."""
        self._reports = Reports()

    def _step(self) -> None:
        """Makes a step and takes note of it, whatever it raises after that."""
        c = ffi.new("drape_step_report *")
        with self._guard:
            if self._recorder:
                self._recorder.refuse_gap()
            status = lib.drape_step(self._world, c)
            report = self._done(c) if status >= 0 else None
            self._calls.raise_kept()
            check(status, "step")
        if report:
            _undiverged(report)

    def _done(self, report: Any) -> StepReport:
        """Takes note of a step's report, for the recorder too."""
        self._report = step_report(report)
        self._now = self._report.step, self._report.time
        self._reports.append(self._report)
        if self._recorder:
            self._recorder.add(report)
        return self._report

    def step(self, n: int = 1) -> Reports:
        """Advances the world by n steps of `dt`.

        Ctrl-C is heard after each step: the world, its arrays and the files of a
        run that is recorded are then those after that step, and `reports` has what
        this call would have returned.

        Returns:
            the reports of the steps

        Raises:
            ValueError: n is negative
            DivergedError: a step was given up; the steps before it are done
            OutOfMemoryError: the next call may succeed
            DeviceError: the device has failed
        """
        n = scenes.whole(n, "step")
        if n < 0:
            raise ValueError(f"step: {n}: expected 0 or more")
        with Held() as held:
            self._begin()
            return self._steps(n, held.deliver)

    def _steps(self, n: int, between: Callable[[], object]) -> Reports:
        """Makes steps, with a call before each, which may raise an exception."""
        try:
            for _ in range(n):
                between()
                self._step()
        finally:
            self._refresh()
        self._look()
        return self._reports

    def _look(self) -> None:
        """Warns of cloths that are stretched too far. The state is not copied from a
        device for it."""
        if self.backend == "ref":
            handle = self._open()
            with handle.lock:
                self._stretch.look(
                    self.steps, handle, self.read, self._triangles, self.bodies
                )

    @property
    def _is_plain(self) -> bool:
        """Whether no step calls a function of Python."""
        calls = self._calls
        return bool(
            self._handle and not calls.log and not calls.trace and not self._recorder
        )

    def _take(self, made: Sequence[Any], status: int) -> None:
        """Takes note of steps that were made, of which those after the last one
        are zeros, and raises what `step` would have raised."""
        try:
            with self._guard:
                for c in made:
                    if c.step or c.outcome:
                        _undiverged(self._done(c))
                check(status, "step")
        finally:
            self._refresh()
        self._look()

    def wake(self) -> None:
        """Wakes all cloths that are asleep, from the next step on."""
        with self._guard:
            lib.drape_wake(self._world)

    def set_wind(self, wind: scenes.Wind | Mapping[str, Any]) -> None:
        """Sets the wind from the next step on, and wakes the scene; what is not
        given stays as it is. Where there is no air yet, its density is 1.2 kg/m³."""
        given = scenes.mapping(wind, "wind", 'keys, as in {"velocity": [5, 0, 0]}')
        new = ffi.new("drape_wind *")
        self._call("drape_read_wind", "wind", new)
        if new.density == 0:
            new.density = 1.2  # as in a scene with the key wind
        for key, value in given.items():
            if key == "velocity":
                new.velocity = scenes.array(value, (3,), "wind.velocity").tolist()
            elif key in ("density", "drag", "lift"):
                setattr(new, key, scenes.number(value, f"wind.{key}"))
            else:
                raise SceneError(fault_of("wind", **{str(key): 0}))
        try:
            self._call("drape_set_wind", "wind", new)
        except SceneError as refused:
            raise told(refused, fault_of("wind", **_plain_wind(new))) from None
        if "velocity" in given and not (new.density and (new.drag or new.lift)):
            warn(
                "wind.velocity: note: has no effect: there is no density, or neither "
                "drag nor lift"
            )

    # The state

    @property
    def triangles(self) -> NDArray[np.int32]:
        """[triangles, 3] vertices of each, which change with the bodies alone."""
        return self._triangles

    @property
    def positions(self) -> NDArray[np.floating[Any]]:
        """[vertices, 3] m, read-only, the cloths in their order and then the
        obstacles. On the host a NumPy array that follows the world: after each
        call of `step` it holds the new state, until bodies come or go. On a
        device a `SharedArray`, whose type `share` tells."""
        return self._array("x")

    @property
    def velocities(self) -> NDArray[np.floating[Any]]:
        """[vertices, 3] m/s, likewise."""
        return self._array("v")

    def share(self) -> tuple[SharedArray, SharedArray]:
        """Returns positions and velocities where they lie, without a copy, on
        the host too: see `SharedArray` for how long they are valid."""
        handle = self._open()
        return (
            SharedArray(handle, "x"),
            SharedArray(handle, "v"),
        )

    def _array(self, field: str) -> NDArray[np.floating[Any]]:
        if self.backend == "gpu":
            return cast("NDArray[np.floating[Any]]", SharedArray(self._open(), field))
        owner = self._mirrors[field]() if field in self._mirrors else None
        if owner is None:
            shared = SharedArray(self._open(), field)
            owner = np.array(shared)
            self._mirrors[field] = weakref.ref(owner)
        view = owner.view()
        view.flags.writeable = False
        return view

    def _refresh(self) -> None:
        """Copies the state to the arrays that someone holds."""
        for field, mirror in list(self._mirrors.items()):
            owner = mirror()
            if owner is None:
                del self._mirrors[field]
            else:
                owner[:] = np.asarray(SharedArray(self._open(), field))

    def read(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Copies positions, m, and velocities, m/s, [vertices, 3] each, to the
        host."""
        x = np.empty((len(self), 3))
        v = np.empty_like(x)
        a, b = (ffi.cast("double (*)[3]", each.ctypes.data) for each in (x, v))
        with self._guard:
            check(lib.drape_read(self._world, a, b), "read")
        return x, v

    def __len__(self) -> int:
        """The number of vertices."""
        return int(lib.drape_vertices(self._open().made))

    def digest(self) -> str:
        """Returns the SHA-256 of the state: positions, then velocities, as
        little-endian numbers of the world's precision. Equal states have equal
        digests on every machine and backend."""
        kind = f"<f{self.precision // 8}"
        sum_of_all = hashlib.sha256()
        for each in self.read():
            sum_of_all.update(each.astype(kind).tobytes())
        return sum_of_all.hexdigest()

    @property
    def stream(self) -> int:
        """The CUDA stream on which the world works; 0 on the host."""
        view = ffi.new("drape_view *")
        with self._guard:
            check(lib.drape_borrow(self._world, view), "borrow")
        return address(view.stream)

    def wait_for(self, stream: int) -> None:
        """Makes the next step wait for what is on this CUDA stream now, as for
        work that still reads a `SharedArray`."""
        order(ffi.cast("void *", stream), self.stream or 1)

    # Plan and memory

    def plan(self) -> list[PlanRow]:
        """Returns the stages, whether the scene uses each, and why."""
        with self._guard:
            count = check(lib.drape_plan(self._world, ffi.NULL, 0), "plan")
            rows = ffi.new("drape_plan_row[]", max(count, 1))
            check(lib.drape_plan(self._world, rows, count), "plan")
        return [
            PlanRow(
                ffi.string(row.stage).decode(),
                bool(row.on),
                ffi.string(row.why).decode(),
                row.bytes,
            )
            for row in rows[0:count]
        ]

    def memory(self) -> Memory:
        """Returns how much memory the world holds."""
        c = ffi.new("drape_memory *")
        with self._guard:
            check(lib.drape_count(self._world, c), "memory")
        return Memory(**_plain(c))

    # Exact checks, files and pictures

    def audit(self, *, threads: int = 0) -> Audit:
        """Finds the intersecting pairs of triangles of the state, exactly.
        Obstacles are not compared with one another."""
        group = np.ones(len(self.triangles), np.int32)
        for body in self.bodies:
            group[body.triangles] = body.kind == "cloth"
        return audit(self.read()[0], self.triangles, group, threads=threads)

    def record(
        self,
        folder: str | os.PathLike[str],
        *,
        obj: bool = False,
        contacts: bool = False,
        force: bool = False,
    ) -> Recorder:
        """Writes the files of a run from here on, as ``drape run`` does: after
        each step its report, and a frame every `steps_per_frame` steps. Use it
        in a with statement, which writes the report at its end.

        Args:
            folder: of this run only; it is made
            obj: whether frames are written as OBJ too
            contacts: whether each frame's contacts are written, and the impulse
                that each body got in each step
            force: whether files of another run are removed from the folder
        """
        if self._recorder:
            raise Error("the world is being recorded already")
        if self.steps:
            raise Error("a run is recorded from its start: before the first step")
        how = ffi.new("core_run_how *", (obj, contacts, force))
        with Held():
            recorder = Recorder(self._open(), folder, how)
            recorder.on_close = self._end_record
            self._recorder = recorder
        return recorder

    def _end_record(self) -> None:
        self._recorder = None

    def export(self, path: str | os.PathLike[str]) -> Path:
        """Writes the state now as a file, by its ending: .ply, or by the package
        meshio (the extra `mesh`) .obj, .off, .stl, .vtk, .vtu; or .npz, with
        velocities, triangles, the sheet at rest and where each body's rows are.

        Returns:
            the path
        """
        from .export.arrays import write_world

        write_world(self, Path(path))
        return Path(path)

    def view(self, **how: Any) -> Viewer:
        """Shows the world on a page for a web browser, where it can be touched; the
        arguments are those of `drape.view`."""
        from .viewer.show import view

        return view(self, **how)

    def render(
        self,
        path: str | os.PathLike[str],
        *,
        width: int = 800,
        height: int = 600,
        samples: int = 8,
    ) -> Path:
        """Makes a picture of the state, as ``drape render`` does, by the scene's
        camera or one that sees all.

        Args:
            path: of the picture, a PNG: it ends in .png
            width, height: in pixels
            samples: a pixel

        Returns:
            the path
        """
        return picture(self._open(), Path(path), width, height, samples)

    def _leave(self, kind: type[BaseException] | None) -> None:
        """A run that is still recorded ends as the with statement does."""
        if self._recorder:
            self._recorder._leave(kind)
        self.close()

    def close(self) -> None:
        """Ends the world. Its memory is released when no array shares it."""
        if self._recorder:
            self._recorder.close()
        self._handle = None

    def __repr__(self) -> str:
        """The world in one line."""
        if self._handle is None:
            return "<drape.World: closed>"
        return (
            f"<drape.World {self.name!r}: {len(self)} vertices, "
            f"{len(self.triangles)} triangles, {self.steps} steps, {self.time:g} s>"
        )

    def _repr_html_(self) -> str:
        """The world in a notebook: one line, and a picture of its state."""
        line = f"<code>{html.escape(repr(self))}</code>"
        if self._handle is None or self._recorder:
            return line
        try:
            with tempfile.TemporaryDirectory(prefix="drape-") as folder:
                path = self.render(Path(folder) / "a.png", width=480, height=360)
                data = base64.b64encode(path.read_bytes()).decode()
        except Error:  # this build has no tool, or the tool draws no pictures
            return line
        return f'{line}<br><img alt="the cloth now" src="data:image/png;base64,{data}">'

    def __reduce__(self) -> Any:
        """Refuses copies and pickles."""
        raise TypeError(
            "a World can be neither copied nor pickled: make another one of the "
            "same scene, and give its restore() what checkpoint() returns"
        )
