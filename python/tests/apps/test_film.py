# SPDX-License-Identifier: Apache-2.0
"""Films of runs."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from needs import need

import drape
from drape.export.cli import main
from drape.export.film import ffmpeg

from .runs import FRAMES, STILL, make

SMALL = {"width": 64, "height": 48, "samples": 1}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 9 frames."""
    return make(tmp_path_factory.mktemp("runs") / "still", STILL)


def pictures(film: Path) -> int:
    """How many pictures ffmpeg finds in a film."""
    words = [ffmpeg(), "-nostdin", "-i", film, "-f", "null", "-"]
    told = subprocess.run(words, capture_output=True, text=True, check=True).stderr
    return int(re.findall(r"frame= *(\d+)", told)[-1])


@pytest.mark.parametrize("others", [False, True])
def test_a_film_has_every_frame(
    run: Path, tmp_path: Path, others: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if others:  # where there is no ffmpeg in PATH
        need("imageio_ffmpeg")
        monkeypatch.setenv("PATH", str(tmp_path))
    elif not shutil.which("ffmpeg"):
        pytest.skip("there is no ffmpeg: sh ci/deps.sh installs it")
    before = sorted(run.rglob("*"))
    assert drape.film(run, tmp_path / "a.mp4", **SMALL) == tmp_path / "a.mp4"
    assert pictures(tmp_path / "a.mp4") == FRAMES + 1
    drape.film(drape.export.Run(run), tmp_path / "b.mp4", every=2, **SMALL)
    assert pictures(tmp_path / "b.mp4") == FRAMES // 2 + 1
    drape.film(run, tmp_path / "c.gif", rate=10, **SMALL)
    assert (tmp_path / "c.gif").read_bytes()[:6] == b"GIF89a"
    assert pictures(tmp_path / "c.gif") == 2 * (FRAMES + 1)  # 20 a second
    assert sorted(run.rglob("*")) == before
    assert sorted(each.name for each in tmp_path.iterdir()) == [
        *("a.mp4", "b.mp4", "c.gif")
    ]


def test_export_makes_films(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if not shutil.which("ffmpeg"):
        need("imageio_ffmpeg")
    film = tmp_path / "a.MP4"
    assert main([str(run), "--to", str(film), "--every", "4"]) == 0
    assert capsys.readouterr().out.startswith(f"{film}: 3 frames")
    assert pictures(film) == 3


def test_what_is_no_film_is_refused(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(drape.SceneError, match=r"expected .* \.mp4 or \.gif"):
        drape.film(run, tmp_path / "a.avi")
    with pytest.raises(drape.SceneError, match="there is no folder"):
        drape.film(run, tmp_path / "none/a.mp4")
    with pytest.raises(drape.SceneError, match=r"report\.json"):
        drape.film(tmp_path, tmp_path / "a.mp4")
    monkeypatch.setenv("PATH", "")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(drape.Error, match="pip install imageio-ffmpeg"):
        drape.film(run, tmp_path / "a.mp4")
