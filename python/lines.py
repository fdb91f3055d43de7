# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of Python in a page, each in a folder of its own.

usage: lines.py PAGE.md…
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path


def blocks(text: str) -> list[str]:
    """Returns a page's blocks of Python."""
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def main(pages: list[str]) -> int:
    """Runs them, and returns how many fail."""
    failed = 0
    for page in pages:
        found = blocks(Path(page).read_text(encoding="utf-8"))
        failed += not found
        for number, block in enumerate(found, 1):
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, "-c", block], cwd=folder)
            print(f"{page}, block {number}: exit status {done.returncode}")
            failed += done.returncode != 0
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
