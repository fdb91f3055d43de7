# SPDX-License-Identifier: Apache-2.0
"""Sweeps into a bucket: a server of S3 in a process of its own, by HTTP."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet
import pytest
import slurmnode
from needs import SLURM, need
from test_sweep import LONG, kill_first, processes

import drape

s3fs = need("s3fs")
need("moto.server")
OUT = "s3://bucket/a sweep"


@pytest.fixture
def storage(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, Any]]:
    """A server with one bucket, as options of fsspec's file system."""
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "test")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
    server = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    url = f"http://127.0.0.1:{port}"
    try:
        end = time.monotonic() + 60
        while True:
            try:
                urllib.request.urlopen(url, timeout=5).close()
                break
            except urllib.error.HTTPError:
                break  # it answers
            except OSError:
                assert server.poll() is None and time.monotonic() < end
                time.sleep(0.1)
        options = {"endpoint_url": url}
        s3fs.S3FileSystem(**options).mkdir("bucket")
        yield options
    finally:
        server.terminate()
        server.wait(30)


def files(storage: dict[str, Any]) -> Any:
    """The bucket as another process sees it: nothing is remembered of before."""
    return s3fs.S3FileSystem(
        **storage, skip_instance_cache=True, use_listings_cache=False
    )


def test_results_are_written_resumed_and_checked(
    tiny: Path, tmp_path: Path, storage: dict[str, Any]
) -> None:
    scenes = drape.grid(tiny, {"dt": [0.01, 0.015, 0.02]})
    same = drape.sweep(scenes, tmp_path, frames=3)
    digests = [row["digest"] for row in same.rows]
    first = drape.sweep(scenes[:2], OUT, frames=3, storage=storage, workers=2)
    assert not first.failed and first.reused == 0
    bucket = files(storage)
    names = {name.rsplit("/", 1)[1] for name in bucket.find("bucket/a sweep/results")}
    ids = [row["id"] for row in same.rows]
    assert names == {f"{each}.{end}" for each in ids[:2] for end in ("npz", "json")}
    # what is in the bucket is the world's state, to the bit
    world = drape.World(tiny, dt=0.01)
    world.step(3)
    assert first.data(0)["positions"].tobytes() == world.positions.tobytes()
    # a digest that is not that of its arrays: this result alone is made again
    path = f"bucket/a sweep/results/{ids[0]}.json"
    row = json.loads(bucket.cat_file(path))
    assert row["digest"] == digests[0]
    row["digest"] = row["digest"][:-1] + ("0" if row["digest"][-1] != "0" else "1")
    bucket.pipe_file(path, json.dumps(row).encode())
    with pytest.raises(drape.Error, match="damaged"):
        first.data(0)
    seen: list[tuple[int, int]] = []
    again = drape.sweep(
        scenes, OUT, frames=3, storage=storage, progress=lambda *n: seen.append(n)
    )
    assert again.reused == 1 and seen == [(2, 3), (3, 3)]
    assert [row["digest"] for row in again.rows] == digests
    with files(storage).open(again.path) as file:
        table = pyarrow.parquet.read_table(file)
    assert table.column("digest").to_pylist() == digests


def test_a_killed_worker(tmp_path: Path, storage: dict[str, Any]) -> None:
    scenes = [LONG, {**LONG, "dt": 0.01}]
    thread, killed = kill_first(
        lambda: processes("drape.sweeps.worker", parent=os.getpid()), after=0.3
    )
    done = drape.sweep(scenes, OUT, storage=storage, workers=2)
    thread.join()
    assert killed and not done.failed
    same = drape.sweep(scenes, tmp_path, workers=2)
    digests = [row["digest"] for row in same.rows]
    with files(storage).open(done.path) as file:
        table = pyarrow.parquet.read_table(file)
    assert table.column("digest").to_pylist() == digests
    assert drape.sweep(scenes, OUT, storage=storage).reused == 2


def test_a_sweep_that_is_killed_goes_on(
    tmp_path: Path, storage: dict[str, Any]
) -> None:
    scenes = [{**LONG, "dt": 0.01 + 0.001 * k} for k in range(3)]
    code = (
        "import drape, json, sys\n"
        "scenes, out, storage = json.loads(sys.argv[1])\n"
        "drape.sweep(scenes, out, storage=storage, workers=1)\n"
    )
    words = json.dumps([scenes, OUT, storage])
    process = subprocess.Popen([sys.executable, "-c", code, words])

    def results() -> int:
        found = files(storage).glob("bucket/a sweep/results/*.json")
        return len(found)

    end = time.monotonic() + 120
    while not results() and time.monotonic() < end:
        time.sleep(0.1)
    process.kill()
    process.wait()
    there = results()
    assert 0 < there < 3
    done = drape.sweep(scenes, OUT, storage=storage, workers=2)
    assert not done.failed and done.reused == there
    same = drape.sweep(scenes, tmp_path, workers=2)
    assert [row["digest"] for row in done.rows] == [row["digest"] for row in same.rows]


@pytest.mark.skipif(
    bool(slurmnode.missing()),
    reason=f"there is no {slurmnode.missing()} ({SLURM})",
)
def test_tasks_of_slurm_write_to_the_bucket(
    tiny: Path,
    tmp_path: Path,
    storage: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenes = drape.grid(tiny, {"dt": [0.01, 0.02]})
    with slurmnode.node(tmp_path / "slurm", 2) as found:
        for name, value in found.items():
            monkeypatch.setenv(name, value)
        options = [f"--output={tmp_path}/%a.log"]
        done = drape.sweep(
            scenes, OUT, on="slurm", frames=2, storage=storage, options=options
        )
    assert not done.failed, (tmp_path / "0.log").read_text()
    same = drape.sweep(scenes, tmp_path / "local", frames=2)
    assert [row["digest"] for row in done.rows] == [row["digest"] for row in same.rows]
