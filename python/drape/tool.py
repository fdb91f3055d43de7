# SPDX-License-Identifier: Apache-2.0
"""The command-line tool: the executable that is built with the package."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

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


def _words(
    arguments: Sequence[str], programs: str = ""
) -> tuple[list[str], dict[str, str]]:
    """Returns the tool's command line and its environment, which has no $DRAPE_TOOL: if
    that names a script of this package, the script takes the package's own tool."""
    seen = {key: text for key, text in os.environ.items() if key != "DRAPE_TOOL"}
    if programs:
        seen["PATH"] = os.pathsep.join([programs, seen.get("PATH", os.defpath)])
    return [str(path()), *arguments], seen


def call(*arguments: object, programs: str = "") -> str:
    """Runs the tool and returns what it prints. A failure raises an exception
    with the tool's last line on standard error.

    Args:
        arguments: of the command line
        programs: a folder of programs that the tool calls, before those of PATH

    Raises:
        SceneError: the tool refused its input
        Error: it failed, or found what it looked for (exit status 1)
    """
    words, seen = _words([str(each) for each in arguments], programs)
    done = subprocess.run(words, env=seen, capture_output=True, text=True)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        raise failure(done.returncode, lines[-1].removeprefix("drape: "))
    return done.stdout


def failure(status: int, text: str) -> Error:
    """Returns what the tool's exit status raises."""
    return (SceneError if status == 2 else Error)(text)


def follow(*arguments: object, log: Callable[[str], object]) -> int:
    """Runs the tool, whose output is not wanted, gives `log` each line that it says
    on standard error, and returns its exit status. An exception, as that of Ctrl-C,
    ends it in order."""
    words, seen = _words([str(each) for each in arguments])
    with subprocess.Popen(
        words,
        env=seen,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    ) as process:
        assert process.stderr
        try:
            for line in process.stderr:
                log(line.rstrip("\n").removeprefix("drape: "))
        except BaseException:
            process.terminate()
            process.wait()
            raise
    return process.returncode


def become(arguments: Sequence[str]) -> NoReturn:
    """Puts the tool in the place of this process, so that signals are for the tool."""
    words, seen = _words(arguments)
    os.execve(words[0], words, seen)
