# SPDX-License-Identifier: Apache-2.0
"""Many scenes: parameter sweeps and data sets, on this machine, Ray or Slurm."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ..errors import Error, need
from .job import Answer, Data, Job, Variant, grid, jobs_of, sample
from .store import Store

Progress = Callable[[int, int], None]

__all__ = ["Sweep", "Variant", "grid", "sample", "sweep"]


class Sweep:
    """What became of a sweep's scenes.

    Attributes:
        rows: a mapping for each scene, in their order, with the columns of the
            table; `status` is "done" or "failed", and `error` says why
        path: of the table in its file system, which is a file of parquet
        reused: how many results were there already
    """

    def __init__(self, store: Store, rows: list[dict[str, Any]], reused: int) -> None:
        """Made by `sweep`."""
        self.store = store
        self.rows = rows
        self.reused = reused
        self.path = store.path("table.parquet")

    def __repr__(self) -> str:
        """How many scenes there were, and what became of them."""
        return (
            f"<drape.Sweep: {len(self.rows)} scenes, {len(self.failed)} failed, "
            f"{self.reused} reused, {self.path}>"
        )

    @property
    def failed(self) -> list[dict[str, Any]]:
        """The rows of the scenes that have no result."""
        return [row for row in self.rows if row["status"] != "done"]

    def data(self, name: str | int) -> Data:
        """Returns a scene's arrays, by its name, its label or its number:
        `positions`, m, and `velocities`, m/s, at the end; the `frames` of the cloths
        that were kept, every `frame_dt` s; and what makes them meshes: `triangles`,
        the sheet at `rest`, m, its `uv`, and where each body's rows are
        (`body_names`, `body_vertices`, `body_triangles`). The file
        results/ID.npz has the same, which `read_meshes` reads.

        Raises:
            Error: there is no result, or its digest is not that of its arrays
        """
        key = name if isinstance(name, str) else self.rows[name]["name"]
        for row in self.rows:
            if key in (row["name"], row["label"]):
                found = self.store.get(row["id"])
                if found and found[0]["digest"] == row["digest"]:
                    return found[1]
                raise Error(f"{key}: {row['error'] or 'its result is damaged'}")
        raise KeyError(f"{key}: no scene has this name")


def sweep(
    scenes: Mapping[str, Any] | Sequence[Any],
    out: str | os.PathLike[str],
    *,
    on: str = "local",
    frames: int | None = None,
    every: int = 0,
    sew: bool = False,
    workers: int | None = None,
    threads: int = 1,
    attempts: int = 3,
    devices: Sequence[int] = (),
    options: Any = None,
    storage: dict[str, Any] | None = None,
    progress: Progress | None = None,
    **keys: Any,
) -> Sweep:
    """Runs many scenes and collects their results in a folder.

    A scene whose result is there already is not run again, so that a sweep that
    was interrupted goes on where it was. Each result is checked by its digest.
    A scene whose worker is killed or lost begins anew; one that is refused, or
    diverges, has failed, and the others go on.

    Args:
        scenes: by names, or a list: what `World` takes, or what `grid` or `sample`
            returns
        out: a folder or a URL that fsspec knows, as s3://bucket/folder
        on: "local": processes of this machine; "ray": a Ray cluster; "slurm":
            job arrays, with `out` on a file system that the nodes share; a URL and
            its storage, which may hold credentials, go to the tasks by a file in
            $XDG_STATE_HOME (~/.local/state), which the nodes then share, too
        frames: to make of each scene; default: as many as it says
        every: of the frames, whose positions are kept; 0: only the end is
        sew: whether each scene's garments are sewn first, as `drape.sew` does in the
            scene's frames at most; `frames`, by default none, go on from there, and
            the rows tell of the seams: how many are open, m of the largest gap,
            N/m of the largest pull, and pairs that intersected in all frames
        workers: jobs at a time; default: as many as processors, or as the
            cluster takes
        threads: of each scene; the number changes no result
        attempts: how often a job may begin
        devices: "local": CUDA's numbers of GPUs, over which workers are spread
        options: "ray": a mapping of its tasks' options, as {"num_gpus": 0.25};
            "slurm": a list of sbatch's, as ["--partition=gpu", "--time=60"]
        storage: options of the file system, as {"endpoint_url": …}
        progress: called with the numbers of scenes done and of all
        keys: replace the scenes' own: backend="gpu", precision=64, …

    Returns:
        the rows of the table that is written to `out`/table.parquet
    """
    _check_kind(on, devices, options)
    _arrow()
    store = Store(os.fspath(out), storage)
    keys = {"threads": threads, **keys}
    jobs = list(jobs_of(scenes, keys, frames, every, sew))
    answers: dict[str, Answer] = {}
    for job in jobs:
        found = store.get(job.id)
        if found:
            answers[job.id] = Answer(row=found[0])
    reused = len(answers)
    todo = list({job.id: job for job in jobs if job.id not in answers}.values())
    for job, answer in _run(todo, store, on, workers, attempts, devices, options):
        if answer.row is not None and answer.data is not None and on != "slurm":
            store.put(job.id, answer.row, answer.data)
        answer.data = None  # it is in the store, and may be large
        answers[job.id] = answer
        if progress:
            progress(len(answers), len(jobs))
    done = Sweep(store, [_row(job, answers[job.id]) for job in jobs], reused)
    _write_table(store, done.rows)
    return done


def _check_kind(on: str, devices: Sequence[int], options: Any) -> None:
    """Refuses a kind of sweep that there is not, and what is of another kind."""
    if on not in ("local", "ray", "slurm"):
        raise Error(f'on={on!r}: expected "local", "ray" or "slurm"')
    if devices and on != "local":
        raise Error(f'devices: of on="local", not of on="{on}": give it options')
    if options and on == "local":
        raise Error('options: of on="ray" and on="slurm", not of on="local"')


def _run(
    jobs: list[Job],
    store: Store,
    on: str,
    workers: int | None,
    attempts: int,
    devices: Sequence[int],
    options: Any,
) -> Iterator[tuple[Job, Answer]]:
    if not jobs:
        return iter(())
    if on == "ray":
        from . import cluster

        return cluster.run(jobs, workers, attempts, dict(options or {}))
    if on == "slurm":
        from . import slurm

        return slurm.run(jobs, store, workers, attempts, list(options or ()))
    from . import local

    return local.run(jobs, workers or os.cpu_count() or 1, attempts, devices)


def _row(job: Job, answer: Answer) -> dict[str, Any]:
    """Returns a scene's row of the table."""
    row = {
        "name": job.name,
        "label": job.label,
        "id": job.id,
        "status": "failed" if answer.row is None else "done",
        "error": answer.error,
    }
    row |= {f"parameter.{key}": value for key, value in job.parameters.items()}
    return row | (answer.row or {"digest": None})


def _arrow() -> tuple[Any, Any]:
    """Returns pyarrow, and what it has of parquet."""
    names = "pyarrow", "pyarrow.parquet"
    arrow, parquet = (need(name, "drape.sweep", "pyarrow") for name in names)
    return arrow, parquet


def _write_table(store: Store, rows: list[dict[str, Any]]) -> None:
    """Writes the rows as one file of parquet; a column of values of several
    types is one of texts."""
    arrow, parquet = _arrow()
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {}
    for name in names:
        values = [row.get(name) for row in rows]
        try:
            columns[name] = arrow.array(values)
        except (arrow.ArrowInvalid, arrow.ArrowTypeError):
            columns[name] = arrow.array([str(value) for value in values])
    sink = arrow.BufferOutputStream()
    parquet.write_table(arrow.table(columns), sink)
    store.write("table.parquet", sink.getvalue().to_pybytes())
