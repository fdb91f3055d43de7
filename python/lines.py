# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of Python in a page, each in a folder of its own.

usage: lines.py PAGE.md…
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path


def blocks(text: str) -> list[str]:
    """Returns a page's blocks of Python."""
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run(page: str, number: int, block: str) -> bool:
    """Runs a block in a folder of its own, and says how it ended."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", block]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    tail = done.stderr[-1000:] if done.returncode else ""
    print(f"{page}, block {number}: exit status {done.returncode}\n{tail}", end="")
    return done.returncode == 0


def main(pages: list[str]) -> int:
    """Runs the blocks, two at a time, and returns how many fail."""
    texts = {page: Path(page).read_text(encoding="utf-8") for page in pages}
    jobs = [
        (page, number, block)
        for page, text in texts.items()
        for number, block in enumerate(blocks(text), 1)
    ]
    with ThreadPoolExecutor(2) as pool:
        good = list(pool.map(lambda job: run(*job), jobs))
    return len(good) - sum(good) if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
