# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of code in a page, each in a folder of its own.

usage: lines.py PAGE.md…      blocks of Python; where a block of text follows one
                              directly, that is what it prints
       lines.py --write PAGE.md… writes what they print into these blocks of text, and
                              gives one to each block of Python that prints; and what
                              the included examples print (tests/test_examples.py)
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
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# The tool with less to do. A view is served until its time is up.
SHORT = """#!/bin/sh
case $1 in
run) set -- "$@" --frames 2 ;;
sew) # whose seams are open then, which exit status 1 says
    {python} -m drape "$@" --frames 2 --no-picture || [ $? -eq 1 ]
    exit ;;
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


@dataclass
class Block:
    """A block of code in a page, and what the page shows that it prints."""

    page: str
    number: int
    code: str
    shown: str | None
    end: int
    """Where the page goes on behind it."""
    printed: str = ""


# A block of text may follow what prints it.
PRINTED = r"(?:\n```text\n(.*?)^```\n)?"
INCLUDED = (
    r"^```{literalinclude} (\S+/examples/\S+\.py)\n:.*?^```\n\n[^\n]+\n" + PRINTED
)


def blocks(page: str, language: str) -> list[Block]:
    """Returns a page's blocks of a language."""
    text = Path(page).read_text(encoding="utf-8")
    pattern = rf"^```{language}\n(.*?)^```\n" + PRINTED
    found = re.finditer(pattern, text, re.MULTILINE | re.DOTALL)
    return [
        Block(page, k, each[1], each[2], each.end()) for k, each in enumerate(found, 1)
    ]


def included(page: str) -> list[Block]:
    """Returns the examples that a page includes, which are no blocks of its own."""
    text = Path(page).read_text(encoding="utf-8")
    made = []
    for each in re.finditer(INCLUDED, text, re.MULTILINE | re.DOTALL):
        code = (Path(page).parent / each[1]).read_text(encoding="utf-8")
        made.append(Block(page, 0, code, each[2], each.end()))
    return made


def write(page: str, made: list[Block]) -> None:
    """Writes what the blocks of a page have printed into it."""
    text = Path(page).read_text(encoding="utf-8")
    for block in sorted(made, key=lambda block: -block.end):
        tail = f"\n```text\n{block.shown}```\n" if block.shown is not None else ""
        new = f"\n```text\n{block.printed}```\n" if block.printed else ""
        start = block.end - len(tail)
        text = text[:start] + new + text[block.end :]
    Path(page).write_text(text, encoding="utf-8")


def commands(block: str, folder: Path) -> tuple[list[str], list[str]]:
    """Returns the command line of a block's commands of the tool, and its other
    commands. The folder gets the tool, the scenes, and a PATH."""
    whole = re.sub(r"\\\n\s*", "", block)  # lines that go on
    lines = [line for line in whole.splitlines() if line and line[0] != "#"]
    tool = [line for line in lines if re.match(r"(build/)?drape ", line)]
    build = folder / "build"
    build.mkdir()
    (build / "drape").write_text(SHORT.format(python=shlex.quote(sys.executable)))
    (build / "drape").chmod(0o755)
    (folder / "app").symlink_to(ROOT / "app")
    path = f'PATH="{build}:{os.environ["PATH"]}"'
    script = "\n".join(["set -e", path, *tool])
    return ["sh", "-c", script], [line for line in lines if line not in tool]


def run(block: Block, language: str, shown: bool) -> bool:
    """Runs a block in a folder of its own, and says how it ended. shown: whether it
    is to print what the page shows."""
    others: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", block.code]
        if language == "sh":
            command, others = commands(block.code, Path(folder))
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    tail = done.stderr[-1000:] if done.returncode else ""
    block.printed = done.stdout
    where = f"{block.page}, block {block.number}"
    print(f"{where}: exit status {done.returncode}\n{tail}", end="")
    for line in others:
        print(f"  not run: {line}")
    same = language == "sh" or not shown or (block.shown or "") == done.stdout
    if not same:
        print(f"{where}: it prints\n{done.stdout}where the page shows\n{block.shown}")
    return done.returncode == 0 and same


def main(arguments: list[str]) -> int:
    """Runs the blocks, two at a time, and returns how many fail."""
    option = arguments[0] if arguments[:1] in (["--sh"], ["--write"]) else ""
    language = "sh" if option == "--sh" else "python"
    pages = arguments[1:] if option else arguments
    jobs = {page: blocks(page, language) for page in pages}
    if option == "--write":
        for page in pages:
            jobs[page] += included(page)
    all_ = [block for page in pages for block in jobs[page]]
    with ThreadPoolExecutor(2) as pool:
        shown = option != "--write"
        good = list(pool.map(lambda block: run(block, language, shown), all_))
    if option == "--write":
        for page in pages:
            write(page, jobs[page])
    return len(good) - sum(good) if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
