# SPDX-License-Identifier: Apache-2.0
"""The command-line tool: the executable that is built with the package."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from .errors import Error, SceneError


def path() -> Path:
    """Returns the tool's executable: that which $DRAPE_TOOL names, so that
    another build can be tried, else the package's own."""
    given = os.environ.get("DRAPE_TOOL")
    file = Path(given) if given else Path(__file__).with_name("bin") / "drape"
    if not shutil.which(file):
        raise Error(
            f"{file}: no such executable: this drape was built without the tool; "
            "$DRAPE_TOOL can name another one"
        )
    return file


def call(*arguments: object) -> str:
    """Runs the tool and returns what it prints. A failure raises an exception
    with the tool's last line on standard error.

    Raises:
        SceneError: the tool refused its input
        Error: it failed, or found what it looked for (exit status 1)
    """
    words = [str(path()), *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        text = lines[-1].removeprefix("drape: ")
        raise (SceneError if done.returncode == 2 else Error)(text)
    return done.stdout


def main(argv: Sequence[str]) -> int:
    """Runs the tool with these arguments and returns its exit status."""
    command = [str(path()), *argv]
    process = subprocess.Popen(command)
    while True:
        try:
            code = process.wait()
            return 128 - code if code < 0 else code
        except KeyboardInterrupt:
            continue  # the tool has it too, and ends its run in order
