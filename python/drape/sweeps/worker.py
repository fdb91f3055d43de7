# SPDX-License-Identifier: Apache-2.0
"""Processes that run jobs.

``python -m drape.sweeps.worker`` takes jobs from its standard input and answers
on its standard output, both pickled; it is the child of `local`.

``python -m drape.sweeps.worker URL JOBS FIRST STEP`` runs jobs FIRST, FIRST +
STEP, … of a file in a store and puts their results there; it is a task of a
Slurm job array. Options of the file system are JSON in $DRAPE_STORE_OPTIONS.
"""

from __future__ import annotations

import json
import os
import pickle
import sys

from .job import attempt
from .store import Store


def serve() -> None:
    """Answers jobs until the standard input ends."""
    # what a library prints must not come between the answers
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            job = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        pickle.dump(attempt(job), answers)
        answers.flush()


def work(url: str, jobs: str, first: int, step: int) -> None:
    """Runs every step-th job of a file, unless its result is there already."""
    store = Store(url, json.loads(os.environ.get("DRAPE_STORE_OPTIONS", "{}")))
    for job in store.get_jobs(jobs)[first::step]:
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
        work(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
