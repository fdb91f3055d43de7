# SPDX-License-Identifier: Apache-2.0
"""Runs jobs on a Ray cluster: the one that Ray is connected to, or that its own
rules find (``RAY_ADDRESS``), else this machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ..errors import need
from .job import Answer, Job, attempt


def run(
    jobs: Sequence[Job], workers: int | None, attempts: int, options: dict[str, Any]
) -> Iterator[tuple[Job, Answer]]:
    """Returns each job with its answer, in the order in which they end.

    Args:
        jobs: the jobs
        workers: at most so many at a time; None: as many as the cluster takes
        attempts: a job whose worker or node is lost begins anew, this often
        options: of the tasks, as num_cpus, num_gpus or scheduling_strategy
    """
    ray = need("ray", 'on="ray"', "ray")
    if not ray.is_initialized():
        ray.init(log_to_driver=False)
    again = {"max_retries": attempts - 1}
    task = ray.remote(attempt).options(**{**again, **options})
    left = list(reversed(jobs))
    most = workers or len(jobs)
    running: dict[Any, Job] = {}
    while left or running:
        while left and len(running) < most:
            job = left.pop()
            running[task.remote(job)] = job
        ready, _ = ray.wait(list(running), num_returns=1)
        for each in ready:
            job = running.pop(each)
            try:
                yield job, ray.get(each)
            except ray.exceptions.RayError as error:
                lines = str(error).strip().splitlines()
                text = lines[0] if lines else ""
                yield job, Answer(error=f"{type(error).__name__}: {text}")
