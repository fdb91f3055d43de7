# SPDX-License-Identifier: Apache-2.0
"""What the commands have in common: one line for an error, and exit codes."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
from typing import Any, NoReturn

# app/base/app.h's app_exit
OK, FINDINGS, USAGE, FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def complain(code: int, text: str) -> int:
    """Prints one line on standard error, and returns the code."""
    line = "".join(c if c.isprintable() else "?" for c in text)
    with contextlib.suppress(OSError):  # there is no other place to say it
        print(f"drape: {line}", file=sys.stderr)
    return code


def say(text: str) -> None:
    """Prints lines on standard output. Where they cannot be written, as nobody reads
    the pipe any more, the command ends, as the tool's do."""
    try:
        print(text, flush=True)
    except OSError as error:
        # what Python still holds of the text is not to be tried again at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        why = f"standard output: cannot write: {error.strerror}"
        raise SystemExit(complain(FAILED, why)) from None


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, as the tool's are, and that knows
    --quiet, as all commands do."""

    def __init__(self, prog: str, description: str) -> None:
        """For the command that `prog` ends with."""
        super().__init__(prog=prog, description=description)
        self.add_argument(
            "--quiet", action="store_true", help="no notes and no closing line"
        )

    def print_help(self, file: Any = None) -> None:
        """Prints the help."""
        say(self.format_help().rstrip())

    def error(self, message: str) -> NoReturn:
        """Ends the process with the exit code of a wrong command line."""
        command = self.prog.split()[-1]
        raise SystemExit(complain(USAGE, f"{command}: {message}"))


def whole(text: str, least: int = 1, most: int = 1000000) -> int:
    """Reads a whole number of a range."""
    if not text.isascii() or not text.isdigit() or not least <= int(text) <= most:
        raise argparse.ArgumentTypeError(
            f"{text}: expected a whole number from {least} to {most}"
        )
    return int(text)


def port(text: str) -> int:
    """Reads a port's number; 0 is any that nobody listens on."""
    return whole(text, 0, 65535)
