# SPDX-License-Identifier: Apache-2.0
"""What a test needs beside the package: where it is missing, the test is skipped
with a reason that names it and the command that installs it."""

from __future__ import annotations

import importlib
import shutil
from typing import Any

import pytest

APPS = "sh ci/deps.sh apps installs it"
SLURM = "sh ci/deps.sh slurm installs it"
# Modules that are no part of tests/requirements.txt, and what installs them.
ELSEWHERE = dict.fromkeys(
    ("pxr", "pygltflib", "trimesh", "viser", "playwright", "PIL", "imageio_ffmpeg"),
    "pip install -r python/tests/apps/requirements.txt",
) | {
    "bpy": "pip install bpy, by the one version of Python that it is for",
    "torch": APPS,
    "cupy": "pip install cupy-cuda13x",
    "ray": "pip install ray",
    "newton": "pip install newton, by which a test takes minutes",
}
OTHERS = "pip install -r python/tests/requirements.txt"


def need(module: str) -> Any:
    """Returns a module. It may be missing itself, and it may lack a library of the
    system, as bpy does on a machine without X."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        top = module.partition(".")[0]
        if error.name not in (top, module):
            raise  # the module is here, and broken
        how = ELSEWHERE.get(top, OTHERS)
        why = f"the module {error.name} is not installed ({how})"
    except ImportError as error:
        why = f"{module} cannot be imported, {error} ({APPS})".replace(": ", ", ")
    pytest.skip(why, allow_module_level=True)


def program(name: str) -> str:
    """Returns the path of one of the programs of Debian that `apps` installs."""
    path = shutil.which(name)
    if not path:
        pytest.skip(f"{name} is not installed ({APPS})")
    return path
