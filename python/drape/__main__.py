# SPDX-License-Identifier: Apache-2.0
"""``python -m drape COMMAND …``: the tool, and the commands that are Python.

The commands of the table below, of which `audit-frames` is a form of `audit`, are
Python modules that expose
``main(argv: list[str]) -> int``, where argv is what follows the command. They
are imported when they are called, so that the tool needs none of their
libraries. All other commands are those of the tool (``man drape``).
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence

COMMANDS = {
    "audit-frames": "drape.referee",
    "examples": "drape.examples",
    "export": "drape.export.cli",
    "sweep": "drape.sweeps.cli",
    "view": "drape.viewer.cli",
}

# Arguments by which `audit` is of frames of other programs: app/tool/audit.c.
FRAMES = ("--frames", "--between")
ENDINGS = (".usd", ".usda", ".usdc", ".usdz", ".abc", ".npz")


def main(argv: Sequence[str]) -> int:
    """Runs one command and returns its exit status."""
    try:
        importlib.import_module("drape._whose")
    except ImportError as error:
        print(f"drape: {error}", file=sys.stderr)
        return 3
    words = list(argv)
    quiet = words[:1] == ["--quiet"]  # it may stand before any command
    name = "".join(words[quiet : quiet + 1])
    if name == "audit" and any(
        word in FRAMES or word.lower().endswith(ENDINGS) for word in words
    ):
        name = "audit-frames"
    if name in COMMANDS:
        module = importlib.import_module(COMMANDS[name])
        return int(module.main(words[:quiet] + words[quiet + 1 :]))
    from drape import tool

    return tool.main(argv)


def entry() -> int:
    """The console script ``drape``."""
    return main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(entry())
