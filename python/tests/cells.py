# SPDX-License-Identifier: Apache-2.0
"""Runs a notebook's cells, but for those whose tags ask for what is not here: torch,
or a device.

usage: cells.py NOTEBOOK.ipynb…
In a kernel of Jupyter where nbclient is installed, and else in this process.
"""

from __future__ import annotations

import importlib.util
import json
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

import drape

Cell = dict[str, Any]


def why_not(tag: str) -> str:
    """Says why cells with a tag cannot run here; empty where they can."""
    if tag == "torch":
        there = importlib.util.find_spec("torch")
        return "" if there else "torch is not installed (sh ci/deps.sh apps)"
    if tag == "device":
        if "gpu: not built in" in drape.info():
            return "the package is built without the device's part"
        try:
            drape.World({"cloths": [{"particles": [3, 3]}]}, backend="gpu").close()
        except drape.Error as error:
            return f"there is no device: {error}"
        return ""
    raise ValueError(f"{tag}: a notebook's tags are torch and device")


def read(path: Path, tags: Collection[str]) -> tuple[dict[str, Any], list[Cell]]:
    """Returns a notebook with those cells of code alone whose tags are among these,
    and these cells."""
    book = json.loads(path.read_text(encoding="utf-8"))
    kept = [
        cell
        for cell in book["cells"]
        if cell["cell_type"] == "code"
        and set(cell["metadata"].get("tags", ())) <= set(tags)
    ]
    return {**book, "cells": kept}, kept


def run_here(cells: list[Cell], name: str) -> None:
    """Runs cells one after another in this process."""
    variables: dict[str, Any] = {"__name__": "__main__"}
    for number, cell in enumerate(cells, 1):
        source = "".join(cell["source"])
        exec(compile(source, f"{name}, cell {number}", "exec"), variables)


def run_in_kernel(book: dict[str, Any], folder: Path) -> list[Cell]:
    """Runs a notebook in a kernel whose folder is this one, and returns its cells
    with their outputs. A cell that fails is nbclient's CellExecutionError."""
    import nbclient
    import nbformat

    node = nbformat.reads(json.dumps(book), as_version=4)
    nbclient.NotebookClient(
        node, timeout=600, resources={"metadata": {"path": str(folder)}}
    ).execute()
    return list(node["cells"])


def main(paths: list[str]) -> int:
    """Runs notebooks; an exception of a cell ends it."""
    reasons = {tag: why_not(tag) for tag in ("torch", "device")}
    for tag, reason in reasons.items():
        if reason:
            print(f"cells with the tag {tag} are skipped: {reason}")
    tags = [tag for tag, reason in reasons.items() if not reason]
    for path in map(Path, paths):
        book, cells = read(path, tags)
        if importlib.util.find_spec("nbclient"):
            run_in_kernel(book, path.parent)
        else:
            run_here(cells, path.name)
        print(f"{path}: {len(cells)} cells ran")
    return 0 if paths else 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
