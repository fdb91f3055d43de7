# SPDX-License-Identifier: Apache-2.0
"""The notebooks of the documentation, in a kernel of Jupyter and without one: on
the host, with torch, and on a device."""

from __future__ import annotations

from pathlib import Path

import cells as notebook
import pytest
from conftest import ROOT
from needs import need

BOOKS = sorted((ROOT / "python/docs").rglob("*.ipynb"))
TAGS = [(), ("torch",), ("torch", "device")]


def test_notebooks_are_kept_without_outputs() -> None:
    assert BOOKS
    for book in BOOKS:
        _, cells = notebook.read(book, ("torch", "device"))
        assert cells and not any(cell["outputs"] for cell in cells)


@pytest.mark.parametrize("tags", TAGS, ids=["host", "torch", "device"])
@pytest.mark.parametrize("path", BOOKS, ids=lambda path: path.stem)
@pytest.mark.parametrize("kernel", [True, False], ids=["kernel", "plain"])
def test_cells_run(
    kernel: bool, path: Path, tags: tuple[str, ...], tmp_path: Path
) -> None:
    for tag in tags:
        reason = notebook.why_not(tag)
        if reason:
            pytest.skip(reason)
    fewer = notebook.read(path, tags[:-1])[1]
    book, cells = notebook.read(path, tags)
    assert len(cells) > (len(fewer) if tags else 0)
    if not kernel:
        notebook.run_here(cells, path.name)
        return
    need("nbclient")
    done = notebook.run_in_kernel(book, tmp_path)
    printed = [out for cell in done for out in cell["outputs"]]
    assert all(cell["execution_count"] for cell in done) and printed


def test_a_cell_that_fails_is_told(tmp_path: Path) -> None:
    cell = {"cell_type": "code", "metadata": {}, "source": ["1 / 0"], "outputs": []}
    with pytest.raises(ZeroDivisionError):
        notebook.run_here([cell], "book")
    client = need("nbclient")
    head = {"metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    code = {**cell, "execution_count": None, "id": "a"}
    with pytest.raises(client.exceptions.CellExecutionError, match="ZeroDivision"):
        notebook.run_in_kernel({**head, "cells": [code]}, tmp_path)
