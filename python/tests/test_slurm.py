# SPDX-License-Identifier: Apache-2.0
"""Sweeps by a real Slurm, which the test starts on this machine where Debian's
slurm-wlm and munge are installed."""

from __future__ import annotations

import getpass
import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import slurmnode
from needs import SLURM
from test_sweep import LONG, kill_first, processes

import drape

pytestmark = pytest.mark.skipif(
    bool(slurmnode.missing()),
    reason=f"there is no {slurmnode.missing()} ({SLURM})",
)


@pytest.fixture(scope="module")
def slurm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    folder = tmp_path_factory.mktemp("slurm")
    with pytest.MonkeyPatch.context() as patch, slurmnode.node(folder, 2) as found:
        for name, value in found.items():
            patch.setenv(name, value)
        yield found


def tasks(out: Path) -> dict[int, int]:
    """The processes of job arrays that run now for the sweep in this folder."""
    return processes(f"drape.sweeps.worker\0{out}/slurm/")


def scenes(n: int) -> list[dict[str, object]]:
    return [{**LONG, "dt": 0.01 + 0.001 * k} for k in range(n)]


def test_a_killed_task_and_what_is_there_already(
    slurm: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "with a space"
    given = [*scenes(3), {"cloths": []}]
    # at once, as a task that has written its result is not made again
    thread, killed = kill_first(lambda: tasks(out), after=0)
    done = drape.sweep(given, out, on="slurm", workers=2)
    thread.join()
    assert killed
    assert [row["status"] for row in done.rows] == ["done"] * 3 + ["failed"]
    assert "cloths" in done.failed[0]["error"]
    # the array, and another of the task that was killed
    assert sorted(p.name for p in (out / "slurm").glob("jobs-*")) == [
        "jobs-0.json",
        "jobs-1.json",
    ]
    assert len(list((out / "slurm").glob("*.log"))) == 5
    same = drape.sweep(given[:3], tmp_path / "local", workers=2)
    assert [r["digest"] for r in done.rows[:3]] == [r["digest"] for r in same.rows]
    assert drape.sweep(given[:3], out, on="slurm").reused == 3


def test_a_cancelled_array_goes_on(slurm: dict[str, str], tmp_path: Path) -> None:
    given = scenes(4)
    out = tmp_path / "out"

    def cancel() -> None:
        end = time.monotonic() + 60
        while time.monotonic() < end and not list((out / "results").glob("*.json")):
            time.sleep(0.05)
        subprocess.run(["scancel", f"--user={getpass.getuser()}"], check=True)

    thread = threading.Thread(target=cancel)
    thread.start()
    # two processors: the last two wait until the first two have ended
    first = drape.sweep(given, out, on="slurm", attempts=1)
    thread.join()
    assert 0 < len(first.failed) < 4
    for row in first.failed:
        told, log = row["error"].split("; its output: ")
        assert told == "the task ended without a result"
        assert Path(log).parent == out / "slurm"
    ready = [row["id"] for row in first.rows if row["status"] == "done"]
    # one of the results is damaged: it is not taken
    file = out / f"results/{ready[0]}.json"
    about = json.loads(file.read_text())
    file.write_text(json.dumps({**about, "digest": "0" * 64}))
    again = drape.sweep(given, out, on="slurm")
    assert not again.failed and again.reused == len(ready) - 1
    same = drape.sweep(given, tmp_path / "local", workers=2)
    assert [r["digest"] for r in again.rows] == [r["digest"] for r in same.rows]


def test_a_sweep_that_is_interrupted_leaves_no_array(
    slurm: dict[str, str], tmp_path: Path
) -> None:
    code = (
        "import drape, json, sys\n"
        "drape.sweep(json.loads(sys.argv[1]), sys.argv[2], on='slurm')\n"
    )
    out = tmp_path / "out"
    words = [json.dumps([{**LONG, "frames": 100000}]), str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", code, *words], stderr=subprocess.DEVNULL
    )
    end = time.monotonic() + 60
    while time.monotonic() < end and not tasks(out):
        time.sleep(0.1)
    assert tasks(out)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) != 0
    end = time.monotonic() + 60
    while time.monotonic() < end and tasks(out):
        time.sleep(0.2)
    assert not tasks(out)
