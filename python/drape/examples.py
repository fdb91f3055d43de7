# SPDX-License-Identifier: Apache-2.0
"""The example scenes that the package has with it."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from .errors import Error, SceneError
from .export.console import OK, USAGE, Parser, complain, say

FOLDER = Path(__file__).with_name("share") / "drape/scenes"
PATTERNS = FOLDER.with_name("patterns")


def names() -> list[str]:
    """Returns the names of the scenes, in their order."""
    found = sorted(path.stem for path in FOLDER.glob("*.json"))
    if not found:
        raise Error(f"{FOLDER}: there are no scenes: this drape is no wheel")
    return found


def path(name: str) -> Path:
    """Returns a scene's file, which `World` and the tool take; README.md beside it
    tells all keys of scenes."""
    if name not in names():
        raise SceneError(f"{name}: no such example; expected one of {names()}")
    return FOLDER / f"{name}.json"


def copy(folder: Path) -> list[Path]:
    """Copies the scenes, the page of their keys and the patterns that they name to a
    folder. Files of these names that are there stay as they are, and are an error."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [path(name) for name in names()] + [FOLDER / "README.md"]
    for file in [*files, PATTERNS]:
        if (folder / file.name).exists():
            raise Error(f"{folder / file.name}: it is there already")
    made = [folder / file.name for file in files]
    for file, to in zip(files, made, strict=True):
        text = file.read_text("utf-8").replace("../patterns/", "patterns/")
        to.write_text(text, "utf-8")
    shutil.copytree(PATTERNS, folder / PATTERNS.name)
    return made


def main(argv: Sequence[str]) -> int:
    """`drape examples`; returns the exit code."""
    parser = Parser(
        prog="drape examples",
        description="List the example scenes, or copy them to a folder.",
    )
    parser.add_argument("folder", metavar="DIR", nargs="?", type=Path)
    given = parser.parse_args(argv)
    try:
        if given.folder is None:
            say("\n".join(names()))
            return OK
        made = copy(given.folder)
    except Error as error:
        return complain(USAGE, f"examples: {error}")
    if not given.quiet:
        say(f"{given.folder}: {len(made)} files")
    return OK
