# SPDX-License-Identifier: Apache-2.0
"""The command-line tool: the executable that is built with the package."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

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


def start(arguments: Sequence[str], **how: Any) -> subprocess.Popen[str]:
    """Starts the tool. Its process does not see $DRAPE_TOOL: if that names a script
    of this package, the script takes the package's own executable."""
    words = [str(path()), *arguments]
    seen = {key: text for key, text in os.environ.items() if key != "DRAPE_TOOL"}
    return subprocess.Popen(words, env=seen, text=True, **how)


def call(*arguments: object) -> str:
    """Runs the tool and returns what it prints. A failure raises an exception
    with the tool's last line on standard error.

    Raises:
        SceneError: the tool refused its input
        Error: it failed, or found what it looked for (exit status 1)
    """
    pipe = subprocess.PIPE
    with start([str(each) for each in arguments], stdout=pipe, stderr=pipe) as process:
        printed, told = process.communicate()
    if process.returncode:
        lines = told.strip().splitlines() or [f"exit status {process.returncode}"]
        text = lines[-1].removeprefix("drape: ")
        raise (SceneError if process.returncode == 2 else Error)(text)
    return printed


def main(argv: Sequence[str]) -> int:
    """Runs the tool with these arguments and returns its exit status."""
    process = start(argv)
    while True:
        try:
            code = process.wait()
            return 128 - code if code < 0 else code
        except KeyboardInterrupt:
            continue  # the tool has it too, and ends its run in order
