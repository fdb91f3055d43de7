# SPDX-License-Identifier: Apache-2.0
"""Runs jobs in processes of this machine."""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence

from .job import Answer, Job

Done = tuple[Job, Answer]


class Worker:
    """A process that runs one job after another, and is replaced if it ends."""

    def __init__(self, device: int | None) -> None:
        """device: the GPU that the process sees, if any is chosen."""
        self.environment = dict(os.environ)
        if device is not None:
            self.environment["CUDA_VISIBLE_DEVICES"] = str(device)
        self.process: subprocess.Popen[bytes] | None = None

    def ask(self, job: Job) -> Answer:
        """Has a job run. A process that ends before it answers has failed."""
        if self.process is None:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "drape.sweeps.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=self.environment,
            )
        assert self.process.stdin and self.process.stdout
        try:
            pickle.dump(job, self.process.stdin)
            self.process.stdin.flush()
            answer: Answer = pickle.load(self.process.stdout)
            return answer
        except Exception as error:  # whatever comes of a process that was killed
            what = "" if isinstance(error, (EOFError, OSError)) else f", {error!r}"
            return Answer(error=f"the worker ended: {self.end()}{what}")

    def end(self) -> str:
        """Ends the process and says how it ended."""
        if self.process is None:
            return ""
        process, self.process = self.process, None
        if process.stdin:
            try:
                process.stdin.close()
            except OSError:
                pass  # it has ended already
        try:
            code = process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        if process.stdout:
            process.stdout.close()
        return f"signal {-code}" if code < 0 else f"exit status {code}"


def run(
    jobs: Sequence[Job], workers: int, attempts: int, devices: Sequence[int]
) -> Iterator[Done]:
    """Returns each job with its answer, in the order in which they end."""
    todo: queue.SimpleQueue[Job] = queue.SimpleQueue()
    done: queue.SimpleQueue[Done] = queue.SimpleQueue()
    stop = threading.Event()
    for job in jobs:
        todo.put(job)

    def serve(worker: Worker) -> None:
        while not stop.is_set():
            try:
                job = todo.get_nowait()
            except queue.Empty:
                break
            answer = Answer()
            for _ in range(attempts):
                answer = worker.ask(job)
                if answer.row is not None or answer.final or stop.is_set():
                    break
            done.put((job, answer))
        worker.end()

    crew = [
        Worker(devices[k % len(devices)] if devices else None)
        for k in range(min(workers, len(jobs)))
    ]
    threads = [threading.Thread(target=serve, args=(worker,)) for worker in crew]
    for thread in threads:
        thread.start()
    try:
        for _ in jobs:
            yield done.get()
    except BaseException:
        stop.set()
        for worker in crew:
            if worker.process:
                worker.process.kill()
        raise
    finally:
        for thread in threads:
            thread.join()
