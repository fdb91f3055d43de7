# SPDX-License-Identifier: Apache-2.0
"""Writes the gallery: a picture of each scene, and the scene behind it.

usage: gallery.py FOLDER [SCENE=FRAME…]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import drape

SECONDS = 5  # between two words on how far a scene is
APP = Path(__file__).resolve().parents[2] / "app"
# Scenes that need no mesh from elsewhere, and the frame of each picture. Those beside
# patterns are sewn.
FRAMES = {
    "worn": 90,
    "sphere": 60,
    "funnel": 60,
    "curtain": 100,
    "poncho": 130,
    "flag": 90,
    "twist": 110,
    "tiny": 40,
}


def run(world: drape.World, frames: int, what: str) -> drape.Reports:
    """Makes these frames, says every few seconds how far it is, and returns the
    reports of all steps."""
    reports: list[drape.StepReport] = []
    said = time.monotonic() - SECONDS
    for frame in range(1, frames + 1):
        reports += world.step(world.steps_per_frame)
        if time.monotonic() - said >= SECONDS or frame == frames:
            said = time.monotonic()
            print(f"{what}, frame {frame} of {frames}", flush=True)
    return drape.Reports(reports)


def sew(file: Path, frames: int, what: str) -> drape.Sewn:
    """Sews a scene, and says every few seconds how far it is."""
    return drape.sew(
        file,
        frames=frames,
        threads=0,
        pictures=False,
        log=lambda line: print(f"{what}: {line}", flush=True),
    )


def main(folder: Path, frames: dict[str, int]) -> None:
    """Runs the scenes, takes the pictures and writes the page."""
    folder.mkdir(parents=True, exist_ok=True)
    page = ["# Gallery\n", "Each picture is of the scene below it, at that frame.\n"]
    for number, (name, frame) in enumerate(frames.items(), 1):
        file = APP / "patterns" / f"{name}.json"
        what = f"gallery: {number} of {len(frames)}: {name}"
        sewn = sew(file, frame, what) if file.exists() else None
        file = file if sewn else APP / "scenes" / f"{name}.json"
        with sewn.world() if sewn else drape.World(file, threads=0) as world:
            done = sewn or run(world, frame, what)
            world.render(folder / f"{name}.png", width=640, height=480)
            about = f"Frame {frame}; {len(world.triangles):,} triangles; "
            about += "every step clean." if done.clean else str(done.outcome)
        text = file.read_text(encoding="utf-8")
        page += [f"## {name}\n", f"![The scene {name}]({name}.png)\n", f"{about}\n"]
        page += [f"```json\n{text}```\n"]
    (folder / "gallery.md").write_text("\n".join(page), encoding="utf-8")


if __name__ == "__main__":
    given = dict(word.split("=") for word in sys.argv[2:])
    main(Path(sys.argv[1]), {k: int(v) for k, v in given.items()} or FRAMES)
