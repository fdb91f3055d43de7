# SPDX-License-Identifier: Apache-2.0
"""Runs jobs as Slurm job arrays. The store must be one that the nodes reach, and
the package installed on them under the same path."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..errors import Error
from .job import Answer, Job
from .store import Store

MOST_TASKS = 1000  # of an array: Slurm's own limit, MaxArraySize, is 1001

# Slurm keeps the script, and shows it to others: it holds neither the store's
# options, which may be credentials, nor a name that somebody else has chosen.
SCRIPT = """#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --array=0-{last}{limit}
exec {python} -m drape.sweeps.worker {order} "$SLURM_ARRAY_TASK_ID"
"""


def log_of(store: Store, name: str, task: str) -> str:
    """Returns the file of a task's output; empty for a store that Slurm cannot
    write to, where the file is in the present folder, by Slurm's own name."""
    return "" if "://" in store.url else store.path(f"slurm/{name}-{task}.log")


def private_folder(store: Store) -> Path:
    """Returns the folder, which the nodes share, of files that nobody else may
    read: the store's own, or where that is no folder one in the user's home."""
    if "://" not in store.url:
        return Path(store.path("slurm"))
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state"
    return Path(state) / "drape"


@contextlib.contextmanager
def order_of(store: Store, name: str, jobs: str, tasks: int) -> Iterator[Path]:
    """Writes what the tasks of an array are told, the store's options with it, to a
    file that its user alone may read, and removes it at the end."""
    about = {"url": store.url, "options": store.options, "jobs": jobs, "tasks": tasks}
    try:
        text = json.dumps(about)
    except TypeError as error:
        raise Error(f"storage: for Slurm, options that JSON holds: {error}") from error
    folder = private_folder(store)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.json"
    try:
        with open(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w") as f:
            f.write(text)
        yield path
    finally:
        path.unlink(missing_ok=True)


def script(name: str, order: Path, tasks: int, workers: int | None) -> str:
    """Returns the batch script of an array of tasks."""
    return SCRIPT.format(
        name=name,
        last=tasks - 1,
        limit=f"%{workers}" if workers else "",
        python=shlex.quote(sys.executable),
        order=shlex.quote(str(order)),
    )


def words(store: Store, name: str, options: Sequence[str]) -> list[str]:
    """Returns the options of sbatch: ours, and then the caller's, each of which may
    be of several words, as in a script."""
    log = log_of(store, name, "\0").replace("%", "%%").replace("\0", "%a")
    ours = [f"--output={log}"] if log else []
    return [*ours, *(word for option in options for word in shlex.split(option))]


def submit(text: str, name: str, options: Sequence[str]) -> None:
    """Submits a batch script, and waits until all of its tasks have ended. How
    they ended is seen from their results. If the wait is interrupted, as by the
    keyboard, the array of this name is cancelled."""
    if not shutil.which("sbatch"):
        raise Error('on="slurm" needs sbatch, which is not in PATH')
    with tempfile.TemporaryDirectory(prefix="drape-") as folder:
        path = Path(folder) / "array.sh"
        path.write_text(text)
        command = ["sbatch", "--wait", "--parsable", *options, str(path)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except BaseException:
            subprocess.run(["scancel", f"--name={name}"], check=False)
            raise
    if done.returncode and not done.stdout.strip():
        raise Error(f"sbatch: {done.stderr.strip() or done.returncode}")


def answer_of(store: Store, job: Job, log: str) -> Answer:
    """Returns what became of a job, whose task's output is in a file."""
    found = store.get(job.id)
    if found:
        return Answer(*found)
    try:
        failed = json.loads(store.read(f"failed/{job.id}.json"))
        return Answer(error=failed["error"], final=failed["final"])
    except (OSError, ValueError, KeyError):
        told = f"; its output: {log}" if log else ""
        return Answer(error=f"the task ended without a result{told}")


def run(
    jobs: Sequence[Job],
    store: Store,
    workers: int | None,
    attempts: int,
    options: Sequence[str],
) -> Iterator[tuple[Job, Answer]]:
    """Returns each job with its answer, when an array has ended; jobs without a
    result are submitted again."""
    if not store.shared:
        raise Error(f'{store.url}: on="slurm" needs a store that the nodes reach')
    if "://" not in store.url:
        store.url = os.path.abspath(store.url)
    left = list(jobs)
    for k in range(attempts):
        tasks = min(len(left), MOST_TASKS)
        jobs_file = f"slurm/jobs-{k}.json"
        name = f"drape-{secrets.token_hex(4)}"
        store.put_jobs(jobs_file, left)
        with order_of(store, name, jobs_file, tasks) as order:
            text = script(name, order, tasks, workers)
            submit(text, name, words(store, name, options))
        again = []
        for number, job in enumerate(left):
            answer = answer_of(store, job, log_of(store, name, str(number % tasks)))
            if answer.row is None and not answer.final and k + 1 < attempts:
                again.append(job)
            else:
                yield job, answer
        left = again
        if not left:
            return
