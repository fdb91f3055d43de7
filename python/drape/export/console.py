# SPDX-License-Identifier: Apache-2.0
"""What the commands have in common: one line for an error, and exit codes."""

from __future__ import annotations

import argparse
import sys
from typing import NoReturn

OK, USAGE, FAILED = 0, 2, 3  # app/base/app.h's app_exit


def complain(code: int, text: str) -> int:
    """Prints one line on standard error, and returns the code."""
    line = "".join(c if c.isprintable() else "?" for c in text)
    print(f"drape: {line}", file=sys.stderr)
    return code


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, as the tool's are, and that knows
    --quiet, as all commands do."""

    def __init__(self, prog: str, description: str) -> None:
        """For the command that `prog` ends with."""
        super().__init__(prog=prog, description=description)
        self.add_argument(
            "--quiet", action="store_true", help="no notes and no closing line"
        )

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
