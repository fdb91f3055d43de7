# SPDX-License-Identifier: Apache-2.0
"""The examples of the pages `Four trades` and `drape beside MuJoCo and Newton` do what
they say, and print what these show."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from needs import need

PAGE = ROOT / "python/docs/tutorials/trades.md"
BESIDE = PAGE.with_name("beside.md")


def example(name: str) -> Any:
    """An example as a module."""
    path = ROOT / "python/examples" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def shown(name: str, page: Path = PAGE) -> list[str]:
    """What a page shows that an example prints."""
    text = page.read_text(encoding="utf-8")
    found = re.search(rf"examples/{name}\.py\n.*?```text\n(.*?)```", text, re.DOTALL)
    assert found, f"{page}: nothing is shown of {name}"
    return found[1].splitlines()


def printed(capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What an example has printed."""
    return capsys.readouterr().out.splitlines()


def test_a_gripper_folds_a_towel(capsys: pytest.CaptureFixture[str]) -> None:
    assert example("gripper").main() > 0.3
    assert printed(capsys) == shown("gripper")


def test_a_closed_loop(capsys: pytest.CaptureFixture[str]) -> None:
    assert example("loop").main() < 0.01
    assert printed(capsys) == shown("loop")


def test_a_data_set(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    x = example("drapes").main(str(tmp_path))
    assert x.shape == (64, 289, 3) and np.isfinite(x).all()
    assert len(np.unique(x.round(6), axis=0)) == 64
    assert printed(capsys) == shown("drapes")


def test_a_fit(capsys: pytest.CaptureFixture[str]) -> None:
    assert 1e-6 < example("fit").main(60) < 3e-6
    assert printed(capsys) == shown("fit")


def test_drape_beside_others(capsys: pytest.CaptureFixture[str]) -> None:
    assert not any(example("beside").main("drape"))
    assert printed(capsys) == shown("beside", BESIDE)


@pytest.mark.parametrize(
    ("by", "package", "least", "most"),
    [
        ("mujoco", "mujoco", 100, 1000),
        ("mujoco-ipc", "mujoco", 0, 0),
        ("newton", "newton", 10, 1000),
    ],
)
def test_others_beside_drape(
    by: str,
    package: str,
    least: int,
    most: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Their last bits, and thus their counts, may be others on another processor."""
    need(package)
    assert least <= max(example("beside").main(by)) <= most
    head, *_ = printed(capsys)
    name = head.partition(":")[0]
    text = BESIDE.read_text(encoding="utf-8")
    assert f"```text\n{name}: 46 frames, " in text
