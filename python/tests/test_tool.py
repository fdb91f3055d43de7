# SPDX-License-Identifier: Apache-2.0
"""``python -m drape`` is the tool."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import SCENES

import drape


def drape_m(*words: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "drape", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_run_and_its_exit_codes(tiny: Path, tmp_path: Path) -> None:
    done = drape_m("run", tiny, "--frames", 2, "--out", tmp_path / "a")
    assert done.returncode == 0 and "2 steps" in done.stdout
    assert (tmp_path / "a/report.json").exists()
    wrong = drape_m("run", tmp_path / "none.json")
    assert wrong.returncode == 2 and wrong.stderr.startswith("drape: ")
    assert drape_m("info").stdout == drape.info()
    assert drape_m().returncode == 2


def test_quiet_before_and_after_a_command(tiny: Path, tmp_path: Path) -> None:
    out = tmp_path / "a"
    for words in (
        ("--quiet", "run", tiny, "--frames", 2, "--out", out),
        ("--quiet", "audit", out / "frames/cloth_0002.ply", out / "obstacles.ply"),
    ):
        done = drape_m(*words)
        assert done.returncode == 0 and not done.stderr
    for words in (("--quiet", "export", out), ("export", out, "--quiet")):
        done = drape_m(*words)  # both are read by Python
        assert done.returncode == 2 and "--to" in done.stderr


def test_an_interrupted_run_ends_in_order(tmp_path: Path) -> None:
    out = tmp_path / "a"
    command = [sys.executable, "-m", "drape", "run", SCENES / "sphere.json"]
    process = subprocess.Popen(
        [*map(str, command), "--out", str(out), "--frames", "100000"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        end = time.monotonic() + 20
        while not (out / "frames/cloth_0001.ply").exists():
            assert time.monotonic() < end and process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 130
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    assert (out / "checkpoint.drape").exists()


@pytest.mark.parametrize("words", [["examples"], ["examples", "--help"], ["info"]])
def test_output_that_nobody_reads(words: list[str]) -> None:
    command = [sys.executable, "-m", "drape", *words]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True) as process:
        assert process.stdout and process.stderr
        process.stdout.close()
        assert process.stderr.read() == (
            "drape: standard output: cannot write: Broken pipe\n"
        )
    assert process.returncode == 3


def test_call_raises_what_the_tool_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(drape.SceneError, match=r"none\.json"):
        drape.tool.call("run", tmp_path / "none.json")
    monkeypatch.setenv("DRAPE_TOOL", str(tmp_path / "nothing"))
    with pytest.raises(drape.Error, match="nothing"):
        drape.tool.call("info")


def test_the_tool_may_be_this_package_s_script(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started = tmp_path / "started"
    script = tmp_path / "drape"
    script.write_text(
        f'#!/bin/sh\necho once >>"{started}"\nexec "{sys.executable}" -m drape "$@"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("DRAPE_TOOL", str(script))
    assert "backend ref" in drape.tool.call("info")
    assert started.read_text() == "once\n"


def test_fetch_models_finds_its_script(tmp_path: Path) -> None:
    lion = tmp_path / "data/models/lion_20k.ply"  # which Debian's archive has
    lion.parent.mkdir(parents=True)
    lion.write_text("here already")
    (tmp_path / "from").mkdir()
    done = drape_m("fetch-models", tmp_path / "data", "--from", tmp_path / "from")
    assert done.returncode == 1  # that folder has nothing
    assert f"missing: {tmp_path}/from/Sample-Queries/" in done.stderr
    assert f"missing: {tmp_path}/from/3Dscanrep/happy" in done.stderr
    assert f"export DRAPE_DATA={tmp_path}/data" in done.stdout
    assert lion.read_text() == "here already"
