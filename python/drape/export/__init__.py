# SPDX-License-Identifier: Apache-2.0
"""Reads the folders of runs, and writes them as USD, glTF and Alembic."""

from drape.export.cli import export
from drape.export.run import Body, Run, RunError

__all__ = ["Body", "Run", "RunError", "export"]
