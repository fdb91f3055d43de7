# SPDX-License-Identifier: Apache-2.0
"""What pip and `python -m build` call in the root of the tree: setuptools, in python/,
and for the archive of the sources a part of the tree as git has it."""

from __future__ import annotations

import gzip
import io
import os
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from setuptools import build_meta

HERE = Path(__file__).resolve().parent
# What the package is made of. Tests, benchmarks and pages are in the repository.
PARTS = (
    *("LICENSE", "CITATION.cff", "Makefile", "pyproject.toml", "bench/bench.mk"),
    "bench/*/speed.csv",
    "tests/golden/stages.txt",  # of which the certificate tells
    *("app", "ci", "gpu", "ref", "spec/*.h", "spec/*.def"),
    *("python", ":!python/tests", ":!python/docs", ":!app/tee.png"),
)


@contextmanager
def inside() -> Iterator[None]:
    """Goes to python/ for the time of its block."""
    before = os.getcwd()
    os.chdir(HERE)
    try:
        yield
    finally:
        os.chdir(before)


def get_requires_for_build_sdist(settings: Any = None) -> list[str]:
    """An archive needs no more than a wheel."""
    return []


def get_requires_for_build_wheel(settings: Any = None) -> list[str]:
    """A wheel needs what pyproject.toml says."""
    return []


def prepare_metadata_for_build_wheel(folder: str, settings: Any = None) -> str:
    """Writes what is said of the package."""
    folder = os.path.abspath(folder)
    with inside():
        return str(build_meta.prepare_metadata_for_build_wheel(folder, settings))


def build_wheel(folder: str, settings: Any = None, metadata: Any = None) -> str:
    """Builds a wheel, which takes its libraries from the machine that it is built on;
    python/wheel.sh makes one for all."""
    folder = os.path.abspath(folder)
    with inside():
        return str(build_meta.build_wheel(folder, settings, None))


def build_sdist(folder: str, settings: Any = None) -> str:
    """Writes the archive of the sources; the same commit gives the same archive."""
    with tempfile.TemporaryDirectory() as work:
        info = Path(work) / prepare_metadata_for_build_wheel(work) / "METADATA"
        about = info.read_bytes()
    fields = dict(
        line.split(": ", 1) for line in about.decode().splitlines()[:3] if ": " in line
    )
    name = f"drape_cloth-{fields['Version']}"
    git = ["git", "-C", str(HERE.parent)]
    listed = subprocess.check_output([*git, "ls-files", "-z", *PARTS], text=True)
    date = subprocess.check_output([*git, "log", "-1", "--format=%ct"], text=True)

    def plain(entry: tarfile.TarInfo) -> tarfile.TarInfo:
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = ""
        entry.mtime = int(date)
        return entry

    path = Path(folder) / f"{name}.tar.gz"
    with (
        gzip.GzipFile(path, "wb", mtime=int(date)) as packed,
        tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
    ):
        for file in sorted(listed.rstrip("\0").split("\0")):
            archive.add(HERE.parent / file, f"{name}/{file}", filter=plain)
        entry = plain(tarfile.TarInfo(f"{name}/PKG-INFO"))
        entry.size = len(about)
        archive.addfile(entry, io.BytesIO(about))
    return path.name
