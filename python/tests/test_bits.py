# SPDX-License-Identifier: Apache-2.0
"""Python and the tool compute the same bits."""

from __future__ import annotations

import csv
import hashlib
import threading
from pathlib import Path

import numpy as np
import pytest

import drape

STEPS = 12


def ply_bytes(path: Path, bits: int, vertices: int) -> bytes:
    """The coordinates in a PLY file of the tool."""
    data = path.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    return data[start : start + vertices * 3 * bits // 8]


@pytest.mark.parametrize("bits", [32, 64])
def test_positions_are_the_tools(tiny: Path, tmp_path: Path, bits: int) -> None:
    drape.tool.call(
        *("run", tiny, "--frames", STEPS, "--precision", bits),
        *("--out", tmp_path / "run", "--no-obj"),
    )
    world = drape.World(tiny, precision=bits)
    cloth = world.bodies[0].vertices
    seen = set()
    for frame in range(STEPS + 1):
        if frame:
            assert world.step().clean
        path = tmp_path / f"run/frames/cloth_{frame:04d}.ply"
        theirs = hashlib.sha256(ply_bytes(path, bits, cloth.stop)).hexdigest()
        ours = hashlib.sha256(np.asarray(world.positions)[cloth].tobytes()).hexdigest()
        assert ours == theirs, f"frame {frame}"
        seen.add(ours)
    assert len(seen) == STEPS + 1  # else equal digests would say nothing
    assert world.report and world.report.contacts > 0


def test_trace_is_the_tools(tiny: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    drape.tool.call("run", tiny, "--frames", 5, "--trace", "--out", out)
    rows: list[tuple[str, str, str]] = []
    world = drape.World(
        tiny,
        trace=lambda step, stage, digest, _: rows.append(
            (str(step), stage, f"{digest:016x}")
        ),
    )
    world.step(5)
    with open(out / "trace.csv", newline="") as file:
        theirs = [tuple(row[:3]) for row in csv.reader(file)][1:]
    assert rows == theirs
    assert len(rows) > 50


def test_record_is_a_run(tiny: Path, tmp_path: Path) -> None:
    drape.tool.call("run", tiny, "--frames", 4, "--out", tmp_path / "a")
    world = drape.World(tiny)
    obj = any(tmp_path.glob("a/frames/*.obj"))  # whether the tool's default is so
    with world.record(tmp_path / "b", obj=obj):
        world.step(4)
    names = sorted(p.relative_to(tmp_path / "a") for p in tmp_path.glob("a/**/*.*"))
    ours = sorted(p.relative_to(tmp_path / "b") for p in tmp_path.glob("b/**/*.*"))
    assert ours == names and len(names) > 7
    for name in names:
        if name.name != "report.json":  # it has wall times
            both = [(tmp_path / x / name).read_bytes() for x in "ab"]
            assert both[0] == both[1], name
    assert drape.tool.call("audit", tmp_path / "b")


def test_threads_have_the_same_bits(tiny: Path) -> None:
    alone = drape.World(tiny)
    alone.step(STEPS)
    worlds = [drape.World(tiny, threads=1 + k % 3) for k in range(6)]
    threads = [threading.Thread(target=world.step, args=(STEPS,)) for world in worlds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {world.digest() for world in worlds} == {alone.digest()}


def test_one_world_in_threads_takes_turns(tiny: Path) -> None:
    alone = drape.World(tiny)
    alone.step(STEPS)
    world = drape.World(tiny)
    threads = [
        threading.Thread(target=world.step, args=(STEPS // 4,)) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert world.digest() == alone.digest()


def test_the_gil_is_released() -> None:
    world = drape.World(drape.Scene(cloths=[drape.Cloth()]), tolerance=1e-9)
    thread = threading.Thread(target=world.step)
    count = 0
    thread.start()
    while thread.is_alive():
        count += 1
    # a step takes tens of ms; a thread that had to wait for it would count to 1
    assert count > 1000
