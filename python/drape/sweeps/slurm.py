# SPDX-License-Identifier: Apache-2.0
"""Runs jobs as Slurm job arrays. The store must be one that the nodes reach, and
the package installed on them under the same path."""

from __future__ import annotations

import json
import os
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

SCRIPT = """#!/bin/sh
#SBATCH --job-name=drape
#SBATCH --array=0-{last}{limit}
{more}export DRAPE_STORE_OPTIONS={options}
exec {python} -m drape.sweeps.worker {url} {jobs} "$SLURM_ARRAY_TASK_ID" {tasks}
"""


def script(
    store: Store, jobs: str, tasks: int, workers: int | None, options: Sequence[str]
) -> str:
    """Returns the batch script of an array of tasks over a file of jobs."""
    return SCRIPT.format(
        last=tasks - 1,
        limit=f"%{workers}" if workers else "",
        more="".join(f"#SBATCH {option}\n" for option in options),
        options=shlex.quote(json.dumps(store.options)),
        python=shlex.quote(sys.executable),
        url=shlex.quote(store.url),
        jobs=shlex.quote(jobs),
        tasks=tasks,
    )


def submit(text: str) -> None:
    """Submits a batch script, and waits until all of its tasks have ended. How
    they ended is seen from their results."""
    if not shutil.which("sbatch"):
        raise Error('on="slurm" needs sbatch, which is not in PATH')
    with tempfile.TemporaryDirectory(prefix="drape-") as folder:
        path = Path(folder) / "array.sh"
        path.write_text(text)
        command = ["sbatch", "--wait", "--parsable", str(path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode and not done.stdout.strip():
        raise Error(f"sbatch: {done.stderr.strip() or done.returncode}")


def answer_of(store: Store, job: Job) -> Answer:
    """Returns what became of a job."""
    found = store.get(job.id)
    if found:
        return Answer(*found)
    try:
        told = json.loads(store.read(f"failed/{job.id}.json"))
        return Answer(error=told["error"], final=told["final"])
    except (OSError, ValueError, KeyError):
        return Answer(error="the task ended without a result")


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
        name = f"slurm/jobs-{k}.pickle"
        store.put_jobs(name, left)
        submit(script(store, name, tasks, workers, options))
        again = []
        for job in left:
            answer = answer_of(store, job)
            if answer.row is None and not answer.final and k + 1 < attempts:
                again.append(job)
            else:
                yield job, answer
        left = again
        if not left:
            return
