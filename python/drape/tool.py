# SPDX-License-Identifier: Apache-2.0
"""The command-line tool: the executable that is built with the package."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path


def path() -> Path:
    """Returns the tool's executable: the package's own, else ``$DRAPE_TOOL``.

    The variable wins, so that a developer's build can be tried."""
    given = os.environ.get("DRAPE_TOOL")
    own = Path(__file__).with_name("bin") / "drape"
    for file in (Path(given) if given else own, own):
        if shutil.which(file):
            return file
    raise FileNotFoundError(
        f"{own}: this installation of drape was built without the tool; name "
        "another one by $DRAPE_TOOL"
    )


def main(argv: Sequence[str]) -> int:
    """Runs the tool with these arguments and returns its exit status."""
    return subprocess.run([path(), *argv], check=False).returncode
