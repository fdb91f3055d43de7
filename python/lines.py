# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of code in a page, each in a folder of its own.

usage: lines.py PAGE.md…      blocks of Python
       lines.py --sh PAGE.md… the commands `drape` of blocks of the shell, in a short
                              form: two frames, small pictures, and `drape view`
                              until it serves. All others are listed.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# The tool with less to do. A view is served until its time is up.
SHORT = """#!/bin/sh
case $1 in
run) set -- "$@" --frames 2 ;;
render) set -- "$@" --width 64 --height 48 --samples 1 ;;
view)
    {python} -m drape "$@" --port 0 >view.log 2>&1 &
    for k in $(seq 120); do
        grep '^http://' view.log && break
        sleep 0.5
    done
    kill $!
    grep -q '^http://' view.log || {{ cat view.log >&2; exit 1; }}
    exit 0 ;;
esac
exec {python} -m drape "$@"
"""


def blocks(text: str, language: str) -> list[str]:
    """Returns a page's blocks of a language."""
    pattern = rf"^```{language}\n(.*?)^```$"
    return re.findall(pattern, text, re.MULTILINE | re.DOTALL)


def commands(block: str, folder: Path) -> tuple[list[str], list[str]]:
    """Returns the command line of a block's commands of the tool, and its other
    commands. The folder gets the tool, the scenes, and a PATH."""
    lines = [line for line in block.splitlines() if line and line[0] != "#"]
    tool = [line for line in lines if re.match(r"(build/)?drape ", line)]
    build = folder / "build"
    build.mkdir()
    (build / "drape").write_text(SHORT.format(python=shlex.quote(sys.executable)))
    (build / "drape").chmod(0o755)
    (folder / "app").symlink_to(ROOT / "app")
    path = f'PATH="{build}:{os.environ["PATH"]}"'
    script = "\n".join(["set -e", path, *tool])
    return ["sh", "-c", script], [line for line in lines if line not in tool]


def run(page: str, number: int, block: str, language: str) -> bool:
    """Runs a block in a folder of its own, and says how it ended."""
    others: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", block]
        if language == "sh":
            command, others = commands(block, Path(folder))
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    tail = done.stderr[-1000:] if done.returncode else ""
    print(f"{page}, block {number}: exit status {done.returncode}\n{tail}", end="")
    for line in others:
        print(f"  not run: {line}")
    return done.returncode == 0


def main(arguments: list[str]) -> int:
    """Runs the blocks, two at a time, and returns how many fail."""
    language = "sh" if arguments[:1] == ["--sh"] else "python"
    pages = arguments[1:] if language == "sh" else arguments
    texts = {page: Path(page).read_text(encoding="utf-8") for page in pages}
    jobs = [
        (page, number, block, language)
        for page, text in texts.items()
        for number, block in enumerate(blocks(text, language), 1)
    ]
    with ThreadPoolExecutor(2) as pool:
        good = list(pool.map(lambda job: run(*job), jobs))
    return len(good) - sum(good) if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
