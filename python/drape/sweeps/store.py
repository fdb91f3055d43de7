# SPDX-License-Identifier: Apache-2.0
"""Where a sweep keeps its results: any file system that fsspec knows.

A result is two files: the arrays, ``results/ID.npz``, and then their record,
``results/ID.json``, which has the digest of the arrays. A result counts if both
are there and the digest is that of the arrays, so that neither a process that
ends while it writes nor a damaged file is taken for a result."""

from __future__ import annotations

import io
import json
import zipfile
from typing import Any

import numpy as np

from .. import _whole
from ..errors import Error, need
from .job import Data, Job, digest


class Store:
    """A folder, by its path or by a URL as s3://bucket/folder."""

    def __init__(self, url: str, options: dict[str, Any] | None = None) -> None:
        """Opens the folder; options are those of the file system in fsspec."""
        fsspec = need("fsspec", "drape.sweep", "fsspec")
        local = need("fsspec.implementations.local", "drape.sweep", "fsspec")
        self.url = url
        self.options = options or {}
        try:
            self.files, self.root = fsspec.core.url_to_fs(url, **self.options)
        except (ImportError, ValueError) as error:
            raise Error(f"{url}: {error}") from error
        self.local = isinstance(self.files, local.LocalFileSystem)

    @property
    def shared(self) -> bool:
        """Whether another process finds the same files there."""
        return type(self.files).__name__ != "MemoryFileSystem"

    def path(self, name: str) -> str:
        """Returns a file's path in its file system."""
        return f"{self.root.rstrip('/')}/{name}"

    def write(self, name: str, data: bytes) -> None:
        """Writes a file, which appears complete or not at all, and the folders that
        it is in."""
        path = self.path(name)
        self.files.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
        if self.local:
            _whole.write(path, data)
            return
        with self.files.open(path, "wb") as file:  # stores of objects do so
            file.write(data)

    def read(self, name: str) -> bytes:
        """Returns a file's bytes; a FileNotFoundError if there is none."""
        with self.files.open(self.path(name), "rb") as file:
            return bytes(file.read())

    def drop(self, name: str) -> None:
        """Removes a file, if it is there."""
        if self.files.exists(self.path(name)):
            self.files.rm(self.path(name))

    def put(self, job: str, row: dict[str, Any], data: Data) -> None:
        """Writes a result."""
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **data)  # type: ignore[arg-type]
        self.write(f"results/{job}.npz", buffer.getvalue())
        self.write(f"results/{job}.json", json.dumps(row).encode())

    def get(self, job: str) -> tuple[dict[str, Any], Data] | None:
        """Returns a result whose digest is right; else None."""
        try:
            row = json.loads(self.read(f"results/{job}.json"))
            with np.load(io.BytesIO(self.read(f"results/{job}.npz"))) as file:
                data = {name: file[name] for name in file.files}
            return (row, data) if row["digest"] == digest(data) else None
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
            return None

    def put_jobs(self, name: str, jobs: list[Job]) -> None:
        """Writes jobs for workers that read them from here."""
        self.write(name, json.dumps([job.plain() for job in jobs]).encode())

    def get_jobs(self, name: str) -> list[Job]:
        """Returns the jobs that `put_jobs` wrote. Whoever can write to the sweep's
        folder can choose which scenes are run, and no more than that."""
        try:
            return [Job.of(each) for each in json.loads(self.read(name))]
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise Error(f"{self.path(name)}: not a sweep's jobs: {error!r}") from error
