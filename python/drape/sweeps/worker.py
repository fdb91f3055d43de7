# SPDX-License-Identifier: Apache-2.0
"""Processes that run jobs.

``python -m drape.sweeps.worker`` takes jobs from its standard input and answers
on its standard output, both pickled; it is the child of `local`.

``python -m drape.sweeps.worker ORDER TASK`` is a task of a Slurm job array. ORDER
is a file of JSON that the sweep has written for its user alone: the store with its
options, its file of jobs, and the number of tasks. The task runs jobs TASK, TASK +
tasks, … and puts their results into the store.
"""

from __future__ import annotations

import json
import os
import pickle
import select
import signal
import sys
import threading
from pathlib import Path

from .job import attempt
from .store import Store


def serve() -> None:
    """Answers jobs until the standard input ends. Where it ends while a job runs, the
    sweep was killed, and nobody waits for the answer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of the terminal, for the sweep
    # what a library prints must not come between the answers
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    threading.Thread(target=_end_with_sweep, daemon=True).start()
    while True:
        try:
            job = pickle.load(sys.stdin.buffer)
        except (EOFError, pickle.UnpicklingError):
            return
        pickle.dump(attempt(job), answers)
        answers.flush()


def _end_with_sweep() -> None:
    """Waits until nobody has the other end of the standard input, and ends the
    process, whatever its job is at."""
    stdin = select.poll()
    stdin.register(0, 0)  # its closing alone, which poll always tells
    stdin.poll()
    os._exit(0)


def work(order: str, task: int) -> None:
    """Runs a task's share of the jobs, but those whose result is there already."""
    about = json.loads(Path(order).read_text(encoding="utf-8"))
    store = Store(about["url"], about["options"])
    for job in store.get_jobs(about["jobs"])[task :: about["tasks"]]:
        if store.get(job.id):
            continue
        store.drop(f"failed/{job.id}.json")
        answer = attempt(job)
        if answer.row is not None and answer.data is not None:
            store.put(job.id, answer.row, answer.data)
        else:
            text = json.dumps({"error": answer.error, "final": answer.final})
            store.write(f"failed/{job.id}.json", text.encode())


if __name__ == "__main__":
    if len(sys.argv) == 1:
        serve()
    else:
        work(sys.argv[1], int(sys.argv[2]))
