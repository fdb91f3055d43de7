# SPDX-License-Identifier: Apache-2.0
"""``python -m drape COMMAND …``: the tool, and the commands that are Python.

The commands of the table below, of which `audit-frames` is a form of `audit` and
`sew-mesh` one of `sew`, are Python modules that expose
``main(argv: list[str]) -> int``, where argv is what follows the command. They
are imported when they are called, so that the tool needs none of their
libraries. All other commands are those of the tool (``man drape``).
"""

from __future__ import annotations

import importlib
import signal
import sys
from collections.abc import Sequence

from drape._endings import PYTHONS

COMMANDS = {
    "audit-frames": "drape.referee",
    "examples": "drape.examples",
    "export": "drape.export.cli",
    "sew-mesh": "drape.sewing_cli",
    "sweep": "drape.sweeps.cli",
    "view": "drape.viewer.cli",
}

# Arguments by which `audit` is of frames of other programs: app/tool/audit.c.
FRAMES = ("--frames", "--between")


def main(argv: Sequence[str]) -> int:
    """Runs one command and returns its exit status; the tool, whose all other commands
    are, takes the place of this process."""
    try:
        importlib.import_module("drape._whose")
    except ImportError as error:
        print(f"drape: {error}", file=sys.stderr)
        return 3
    words = list(argv)
    quiet = words[:1] == ["--quiet"]  # it may stand before any command
    name = "".join(words[quiet : quiet + 1])
    if name == "audit" and any(
        word in FRAMES or word.lower().endswith(PYTHONS) for word in words
    ):
        name = "audit-frames"
    if name in COMMANDS:
        return _call(name, words[:quiet] + words[quiet + 1 :])
    from drape import tool

    tool.become(argv)


def _call(name: str, words: Sequence[str]) -> int:
    """Runs a command that is Python. Ctrl-C and SIGTERM end it in order, so that
    what it has begun to write goes, and its processes with it."""
    from drape.export.console import FAILED, INTERRUPTED, complain

    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    module = COMMANDS[name]
    name = name.partition("-")[0]
    try:
        return int(importlib.import_module(module).main(words))
    except KeyboardInterrupt:
        return complain(INTERRUPTED, f"{name}: interrupted")
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return complain(FAILED, f"{name}: {where}{error.strerror or error}")
    finally:
        signal.signal(signal.SIGTERM, before)


def entry() -> int:
    """The console script ``drape``."""
    return main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(entry())
