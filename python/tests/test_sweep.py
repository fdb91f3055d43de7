# SPDX-License-Identifier: Apache-2.0
"""Sweeps: results, what is resumed, and what becomes of lost workers."""

from __future__ import annotations

import base64
import contextlib
import io
import json
import os
import pickle
import re
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest
from needs import need

import drape
from drape.__main__ import main

# Long enough to be killed while it runs.
LONG = {
    "name": "long",
    "cloths": [{"particles": [61, 61], "start": {"at": [0, 0.5, 0]}}],
    "obstacles": [{"shape": "sphere", "radius": 0.3, "detail": 24}],
    "frames": 48,  # long enough to be killed on a fast machine
}


def processes(words: str, parent: int | None = None) -> dict[int, int]:
    """The running processes with these words in their command: to its parent."""
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and words in (entry / "cmdline").read_text():
                fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
                if parent in (None, int(fields[1])) and fields[0] != "Z":
                    found[int(entry.name)] = int(fields[1])
        except OSError:
            continue  # it has ended
    return found


def kill_first(
    find: Callable[[], Any], after: float = 0.7
) -> tuple[threading.Thread, list[int]]:
    """Kills the first process that is found, so many seconds after it is.

    Two nodes of Ray and their workers take a minute or more to start where others
    use the processors.
    """
    killed: list[int] = []

    def watch() -> None:
        end = time.monotonic() + 300
        while not killed and time.monotonic() < end:
            for process in find():
                time.sleep(after)
                with contextlib.suppress(ProcessLookupError):  # it has ended
                    os.kill(process, signal.SIGKILL)
                    killed.append(process)
                    return
            time.sleep(0.02)

    thread = threading.Thread(target=watch)
    thread.start()
    return thread, killed


def test_results_are_the_worlds(tiny: Path, tmp_path: Path) -> None:
    variants = drape.grid(tiny, {"dt": [0.01, 0.02], "precision": [32, 64]})
    done = drape.sweep(variants, tmp_path, frames=6, every=3, workers=2)
    assert not done.failed and done.reused == 0 and len(done.rows) == 4
    for row, variant in zip(done.rows, variants, strict=True):
        world = drape.World(tiny, **variant.parameters)
        world.step(3)
        middle = world.positions.copy()
        world.step(3)
        data = done.data(row["name"])
        assert data["positions"].tobytes() == world.positions.tobytes()
        assert data["velocities"].tobytes() == world.velocities.tobytes()
        cloth = world.bodies[0].vertices
        assert data["frames"].shape[0] == 3
        assert data["frames"][1].tobytes() == middle[cloth].tobytes()
    table = pyarrow.parquet.read_table(done.path)
    assert table.column("parameter.dt").to_pylist() == [0.01, 0.01, 0.02, 0.02]
    assert table.column("digest").to_pylist() == [row["digest"] for row in done.rows]
    assert table.column("clean").to_pylist() == [True] * 4
    assert len(set(table.column("digest").to_pylist())) == 4


def test_a_result_is_a_mesh_by_itself(tiny: Path, tmp_path: Path) -> None:
    axes = {"dt": [0.01, 0.02], "cloths.0.material.bend": [1e-5]}
    done = drape.sweep(drape.grid(tiny, axes), tmp_path, frames=4, every=2)
    labels = [row["label"] for row in done.rows]
    assert labels == ["dt=0.01, bend=1e-05", "dt=0.02, bend=1e-05"]
    data = done.data(labels[1])
    world = drape.World(tiny, dt=0.02)
    assert np.array_equal(data["triangles"], world.triangles)
    assert np.array_equal(data["rest"][world.bodies[0].vertices], world.bodies[0].rest)
    assert data["body_names"].tolist() == [each.name for each in world.bodies]
    file = tmp_path / "results" / f"{done.rows[1]['id']}.npz"
    cloth, ball = drape.read_meshes(file).values()
    assert cloth.frames is not None and len(cloth.frames) == 3
    assert cloth.frame_dt == pytest.approx(2 * world.steps_per_frame * 0.02)
    assert ball.frames is None and ball.kind == "obstacle"
    assert drape.audit_frames(cloth.frames, cloth.triangles)[2].pairs == 0


def test_draws_follow_from_the_seed(tiny: Path) -> None:
    axes: dict[str, Any] = {
        "dt": (0.01, 0.02),
        "cloths.0.material.name": ["denim", "silk"],
        "cloths.0.material.friction": lambda random: random.choice([0.1, 0.2]),
    }
    few, many = (drape.sample(tiny, axes, count, seed=7) for count in (3, 8))
    assert [each.parameters for each in few] == [each.parameters for each in many[:3]]
    assert len({each.parameters["dt"] for each in many}) == 8
    assert all(0.01 <= each.parameters["dt"] < 0.02 for each in many)
    assert {each.parameters["cloths.0.material.name"] for each in many} == {
        *("denim", "silk")
    }
    assert [each.parameters["draw"] for each in few] == [0, 1, 2]
    other = drape.sample(tiny, axes, 3, seed=8)
    assert other[0].parameters["dt"] != few[0].parameters["dt"]


def test_the_command(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(tiny), "--out", str(tmp_path / "a"), "--frames", "2"]
    values = ["--set", "cloths.0.material=denim,silk", "--set", "dt=0.01,0.02"]
    assert main(["sweep", *words, *values]) == 0
    told = capsys.readouterr().out
    assert told == f"{tmp_path}/a/table.parquet: 4 scenes, 0 failed, 0 reused\n"
    assert main(["sweep", *words, "--set", "dt=0.01,-1"]) == 1
    assert "dt=-1: failed: SceneError: " in capsys.readouterr().err
    draw = ["--draw", "dt=0.01..0.02", "--count", "3", "--seed", "5", "--quiet"]
    assert main(["sweep", *words, *draw]) == 0 and not capsys.readouterr().out
    for wrong, text in (
        (["--draw", "dt=0.01..0.02"], "--draw and --count go together"),
        (["--set", "dt=1", *draw], "expected --set, for all combinations, or --draw"),
        (["--set", "cloths.9.a=1"], "cloths.9.a: the scene has no such place"),
        (["--set", "dtt=0.01,0.02"], 'unknown key "dtt"; did you mean "dt"?'),
    ):
        assert main(["sweep", *words, *wrong]) == 2
        told = capsys.readouterr().err
        assert text in told and told.count("\n") == 1
    for wrong, text in ((["--draw", "dt=1"], "LO..HI"), (["--set", "dt"], "KEY=")):
        with pytest.raises(SystemExit) as end:
            main(["sweep", *words, *wrong])
        assert end.value.code == 2 and text in capsys.readouterr().err


def test_a_sweep_of_a_file_has_its_arrays_and_meshes(tmp_path: Path) -> None:
    x = np.array([[0, 0.5, 0], [1, 0.5, 0], [0, 0.5, 1], [1, 0.5, 1]])
    scene = drape.Scene(
        cloths=[drape.Cloth(particles=[2, 2], positions=x)],
        obstacles=[drape.Obstacle(vertices=x - [0, 1, 0], triangles=[[0, 2, 1]])],
    )
    (tmp_path / "in").mkdir()
    scene.save(tmp_path / "in/a.json")
    variants = drape.grid(tmp_path / "in/a.json", {"dt": [0.01]})
    done = drape.sweep(variants, tmp_path / "out", frames=0)
    expected = np.concatenate([x, x - [0, 1, 0]])
    assert np.array_equal(done.data(0)["positions"], expected.astype(np.float32))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_killed_sweep_goes_on(number: signal.Signals, tmp_path: Path) -> None:
    file, out = tmp_path / "long.json", tmp_path / "out"
    file.write_text(json.dumps(LONG))
    words = ["sweep", str(file), "--out", str(out), "--set", "dt=0.01,0.011,0.012"]
    command = [sys.executable, "-m", "drape", *words, "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while not list(out.glob("results/[!.]*.json")):
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(number)
        assert process.stderr
        told = process.stderr.read()  # which its worker has, too
    killed = number == signal.SIGKILL
    assert process.returncode == (-9 if killed else 130)
    assert told == ("" if killed else "drape: sweep: interrupted\n")
    done = len(list(out.glob("results/[!.]*.json")))
    for file in out.glob("results/[!.]*"):  # SIGKILL may leave .ID.part.npz
        assert np.load(file) if file.suffix == ".npz" else json.loads(file.read_text())
    again = subprocess.run(command, capture_output=True, text=True)
    assert again.stdout.endswith(f": 3 scenes, 0 failed, {done} reused\n")


def test_a_sweep_is_resumed_and_damage_is_seen(tiny: Path, tmp_path: Path) -> None:
    scenes = drape.grid(tiny, {"dt": [0.01, 0.011, 0.012, 0.013]})
    first = drape.sweep(scenes[:3], tmp_path, frames=3)
    digests = [row["digest"] for row in first.rows]
    results = tmp_path / "results"
    # of the three results, one is damaged, and one is not complete
    damaged, partial = (results / first.rows[k]["id"] for k in (0, 1))
    row = json.loads(damaged.with_suffix(".json").read_text())
    data = dict(np.load(damaged.with_suffix(".npz")))
    data["positions"][0, 0] += 1
    np.savez_compressed(damaged.with_suffix(".npz"), **data)
    partial.with_suffix(".json").unlink()
    with pytest.raises(drape.Error, match="damaged"):
        first.data(0)
    seen: list[tuple[int, int]] = []
    again = drape.sweep(scenes, tmp_path, frames=3, progress=lambda *n: seen.append(n))
    assert again.reused == 1 and seen == [(2, 4), (3, 4), (4, 4)]
    assert [row["digest"] for row in again.rows[:3]] == digests
    assert row["digest"] == digests[0] and again.data(0)["positions"].shape
    assert drape.sweep(scenes, tmp_path, frames=3).reused == 4
    assert drape.sweep(scenes, tmp_path, frames=4).reused == 0


def test_failures_are_listed(tiny: Path) -> None:
    scenes = {
        "good": tiny,
        "refused": {"cloths": [{"particles": [1, 2]}]},
        "diverged": drape.Scene(
            cloths=[
                drape.Cloth(particles=[9, 9], material={"stretch": 1e8, "shear": 0})
            ],
            integrator="euler",
            max_substeps=1,
        ),
    }
    done = drape.sweep(scenes, "memory://failures", frames=3, workers=2)
    assert [row["status"] for row in done.rows] == ["done", "failed", "failed"]
    assert [row["name"] for row in done.failed] == ["refused", "diverged"]
    assert "particles" in done.rows[1]["error"]
    assert done.data("good")["positions"].shape == (143, 3)
    with pytest.raises(drape.Error, match=r"refused: SceneError: .*particles"):
        done.data("refused")
    with done.store.files.open(done.path) as file:
        table = pyarrow.parquet.read_table(file)
    assert table.column("status").to_pylist() == ["done", "failed", "failed"]
    assert table.column("digest").to_pylist()[1] is None


def test_a_killed_worker(tmp_path: Path) -> None:
    scenes = [LONG, {**LONG, "dt": 0.01}, {**LONG, "dt": 0.012}]
    thread, killed = kill_first(
        lambda: processes("drape.sweeps.worker", parent=os.getpid())
    )
    done = drape.sweep(scenes, tmp_path, workers=2)
    thread.join()
    assert killed and not done.failed
    world = drape.World(LONG)
    world.step(LONG["frames"])
    assert done.data(0)["positions"].tobytes() == world.positions.tobytes()


def test_a_worker_that_always_dies(tmp_path: Path) -> None:
    stop = threading.Event()

    def watch() -> None:
        while not stop.wait(0.05):
            for process in processes("drape.sweeps.worker", parent=os.getpid()):
                with contextlib.suppress(ProcessLookupError):  # it has ended
                    os.kill(process, signal.SIGKILL)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        done = drape.sweep([LONG], tmp_path, attempts=2)
    finally:
        stop.set()
        thread.join()
    assert len(done.failed) == 1
    assert done.failed[0]["error"] == "the worker ended: signal 9"


def test_devices_are_spread() -> None:
    from drape.sweeps.local import Worker

    assert Worker(3).environment["CUDA_VISIBLE_DEVICES"] == "3"


def test_wrong_arguments(tiny: Path, tmp_path: Path) -> None:
    with pytest.raises(drape.Error, match="local"):
        drape.sweep([tiny], tmp_path, on="mars")
    with pytest.raises(drape.Error, match="devices: of on="):
        drape.sweep([tiny], tmp_path, on="ray", devices=[0])
    with pytest.raises(drape.Error, match="options: of on="):
        drape.sweep([tiny], tmp_path, options=["--time=1"])
    with pytest.raises(drape.Error, match=r"floppy://a: .*floppy"):
        drape.sweep([tiny], "floppy://a")
    with pytest.raises(drape.SceneError, match=r"cloths\.3\.size"):
        drape.grid(tiny, {"cloths.3.size": [1]})
    with pytest.raises(drape.Error, match="nodes reach"):
        drape.sweep([tiny], "memory://slurm", on="slurm")


# Stands in for Slurm's sbatch --wait: it runs the tasks of an array here, one
# after another. Its task 1 is killed the first time, as by a lost node.
# The shell's line is text to Python: a path with spaces cannot follow #!.
SBATCH = """#!/bin/sh
"exec" "{python}" "$0" "$@"
import os, pathlib, re, signal, subprocess, sys
text = open(sys.argv[-1]).read()
last = int(re.search(r"--array=0-(\\d+)", text)[1])
here = pathlib.Path(__file__).parent
count = len(list(here.glob("script-*")))
(here / f"script-{{count}}").write_text(text)
(here / f"words-{{count}}").write_text("\\n".join(sys.argv[1:-1]))
order = re.search(r"worker (\\S+) ", text)[1].strip("'")
(here / f"order-{{count}}").write_text(oct(os.stat(order).st_mode)[-3:] + order)
print(4242 + count)
failed = 0
for task in range(last + 1):
    environment = dict(os.environ, SLURM_ARRAY_TASK_ID=str(task))
    process = subprocess.Popen(["sh", sys.argv[-1]], env=environment)
    if count == 0 and task == 1:
        process.send_signal(signal.SIGKILL)
    failed |= process.wait() != 0
sys.exit(failed)
"""


def test_slurm(tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = tmp_path / "bin/sbatch"
    fake.parent.mkdir()
    fake.write_text(SBATCH.format(python=sys.executable))
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{fake.parent}:{os.environ['PATH']}")
    scenes = [*drape.grid(tiny, {"dt": [0.01, 0.02, 0.03]}), {"cloths": []}]
    done = drape.sweep(
        scenes,
        tmp_path / "out",
        on="slurm",
        frames=3,
        workers=8,
        options=["--time=10"],
    )
    assert [row["status"] for row in done.rows] == ["done"] * 3 + ["failed"]
    assert "cloths" in done.failed[0]["error"]
    scripts = sorted(fake.parent.glob("script-*"))
    assert len(scripts) == 2  # the task that was killed is submitted again
    text = scripts[0].read_text()
    name = re.search(r"--job-name=(drape-\w+)\n", text)
    assert name and "#SBATCH --array=0-3%8\n" in text
    log = tmp_path / f"out/slurm/{name[1]}-%a.log"
    words = (fake.parent / "words-0").read_text()
    assert words == f"--wait\n--parsable\n--output={log}\n--time=10"
    mode, order = (lambda t: (t[:3], Path(t[3:])))(
        (fake.parent / "order-0").read_text()
    )
    assert mode == "600" and order.parent == tmp_path / "out/slurm"
    assert not order.exists()  # it goes with the array
    assert "#SBATCH --array=0-0%8" in scripts[1].read_text()
    same = drape.sweep(scenes[:3], tmp_path / "local", frames=3)
    assert [r["digest"] for r in done.rows[:3]] == [r["digest"] for r in same.rows]
    monkeypatch.setenv("PATH", "/nothing")
    with pytest.raises(drape.Error, match="sbatch"):
        drape.sweep([{**LONG, "frames": 1}], tmp_path / "out", on="slurm")


class Bucket:
    """A store with credentials, as an array of Slurm's sees it."""

    url, options = "s3://user:p4ssw0rd@bucket/sweep", {"secret": "s3cr3t"}

    def path(self, name: str) -> str:
        return f"{self.url}/{name}"


def test_slurm_is_told_no_secret(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The batch script, which Slurm keeps, has neither the store's options nor a
    name that somebody has chosen: a new line in it would begin a directive."""
    from drape.sweeps import slurm

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    store: Any = Bucket()
    with slurm.order_of(store, "drape-0", "slurm/jobs-0.json", 3) as order:
        assert stat.S_IMODE(order.stat().st_mode) == 0o600
        assert json.loads(order.read_text())["options"] == store.options
        told = [slurm.script("drape-0", order, 3, None), *slurm.words(store, "d", ())]
        assert not any("s3" in each or "p4ss" in each for each in told)
    assert list((tmp_path / "state/drape").iterdir()) == []
    odd = drape.sweeps.Store(str(tmp_path / 'a"\n#SBATCH --wrap=echo'))
    with slurm.order_of(odd, "drape-1", "slurm/jobs-0.json", 3) as order:
        directives = [
            line
            for line in slurm.script("drape-1", order, 3, 2).splitlines()
            if line.startswith("#SBATCH")
        ]
        # sbatch reads no directive behind the first command
        before = slurm.script("drape-1", order, 3, 2).split("\nexec ")[0].splitlines()
        assert (
            before[1:] == [*("#SBATCH --job-name=drape-1", "#SBATCH --array=0-2%2")]
            and directives[:2] == before[1:]
        )
    assert slurm.words(odd, "d", ["-p gpu", "--time=1"])[1:] == [
        "-p",
        "gpu",
        "--time=1",
    ]


def test_jobs_are_data(tmp_path: Path) -> None:
    """Jobs that a store holds are JSON: reading them runs nothing."""
    from drape.sweeps.job import jobs_of
    from drape.sweeps.store import Store

    x = np.random.default_rng(1).random((4, 3))
    scene = {
        "cloths": [{"particles": [2, 2], "positions": x}],
        "obstacles": [
            {
                "vertex_frames": np.float32([x, x + 1]),
                "triangles": [[0, 1, 2]],
                "frame_dt": 0.25,
                "between": "cubic",
            }
        ],
    }
    jobs = list(jobs_of([scene, {"cloths": [{}]}], {"dt": 0.01}, 5, 2))
    store = Store(str(tmp_path))
    store.put_jobs("slurm/jobs-0.json", jobs)
    again = store.get_jobs("slurm/jobs-0.json")
    assert [job.id for job in again] == [job.id for job in jobs]
    assert again[0].scene.cloths[0]["positions"].tobytes() == x.tobytes()
    assert again[0].scene.obstacles[0]["frame_dt"] == 0.25
    assert again[0].scene.obstacles[0]["between"] == "cubic"
    assert (again[0].frames, again[0].every) == (5, 2)

    class Evil:
        def __reduce__(self) -> Any:
            return os.mkdir, (str(tmp_path / "run"),)

    objects = io.BytesIO()
    np.save(objects, np.array([Evil()], dtype=object))
    plain = jobs[0].plain()
    plain["cloths"][0]["positions"] = base64.b64encode(objects.getvalue()).decode()
    for wrong in (pickle.dumps([Evil()]), json.dumps([plain]).encode(), b"[1]", b"{"):
        store.write("slurm/jobs-0.json", wrong)
        with pytest.raises(drape.Error, match=r"jobs-0\.json: not a sweep's jobs"):
            store.get_jobs("slurm/jobs-0.json")
    assert not (tmp_path / "run").exists()


def test_ray_on_two_nodes_loses_a_worker_and_a_node(tmp_path: Path) -> None:
    os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")
    ray = need("ray")
    from ray.cluster_utils import Cluster

    memory = 100 * 2**20
    cluster = Cluster(
        initialize_head=True,
        head_node_args={"num_cpus": 1, "object_store_memory": memory},
    )
    nodes: set[int] = set()

    def tasks() -> list[int]:
        found = processes("ray::attempt")
        nodes.update(found.values())  # a worker's parent is its node's raylet
        return sorted(found) if len(nodes) == 2 else []

    try:
        node = cluster.add_node(num_cpus=1, object_store_memory=memory)
        ray.init(address=cluster.address, log_to_driver=False)
        assert sum(node["Alive"] for node in ray.nodes()) == 2
        thread, killed = kill_first(tasks)

        def lose() -> None:
            thread.join()
            time.sleep(1)
            cluster.remove_node(node, allow_graceful=False)

        loss = threading.Thread(target=lose)
        loss.start()
        scenes = [{**LONG, "dt": dt, "frames": 36} for dt in (0.01, 0.011, 0.012)]
        done = drape.sweep(scenes, tmp_path / "ray", on="ray")
        loss.join()
    finally:
        ray.shutdown()
        cluster.shutdown()
    assert killed and len(nodes) == 2 and not done.failed
    same = drape.sweep(scenes, tmp_path / "local")
    assert [row["digest"] for row in done.rows] == [row["digest"] for row in same.rows]
