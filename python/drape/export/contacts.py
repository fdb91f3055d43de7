# SPDX-License-Identifier: Apache-2.0
"""Reads the contacts of a run's frame, which `drape run --contacts` writes: a PLY
of points, which plyfile, meshio and others read, too."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drape.contacts import Pairs

_AXES = "xyz"
_ROW = np.dtype(
    [
        *((axis, "<f8") for axis in _AXES),
        *((f"n{axis}", "<f8") for axis in _AXES),
        ("gap", "<f8"),
        *((f"impulse_{axis}", "<f8") for axis in _AXES),
        *((f"weight_{k}", "<f8") for k in range(4)),
        *((f"vertex_{k}", "<i4") for k in range(4)),
        *((name, "<i4") for name in ("kind", "body_a", "body_b")),
    ]
)
_KINDS = {"<f8": "double", "<i4": "int"}
_HEADER = re.compile(
    r"ply\nformat binary_little_endian 1\.0\n(?:comment contacts [^\n]*\n)"
    r"comment slice (\S+)\nelement vertex (\d+)\n"
    + "".join(
        f"property {_KINDS[_ROW.fields[name][0].str]} {name}\n"
        for name in _ROW.names or ()
        if _ROW.fields
    )
    + "end_header\n"
)


@dataclass(frozen=True, eq=False)
class FrameContacts(Pairs):
    """The pairs of a frame's last step. A body's number is that in the list of the
    run's report.

    Attributes:
        points: [n, 3] m, where they touch, on side A
    """

    points: NDArray[np.float64]


def _columns(rows: NDArray[np.void], names: list[str]) -> NDArray[np.float64]:
    return np.stack([rows[name].astype(np.float64) for name in names], 1)


def read_contacts(path: Path) -> FrameContacts:
    """Returns the contacts of a file that a run has written.

    Raises ValueError, with the file's name, if it is none."""
    data = path.read_bytes()
    head = _HEADER.match(data[:2048].decode("latin-1"))
    if not head:
        raise ValueError(f"{path}: expected contacts as `drape run` writes them")
    count = int(head[2])
    if len(data) != head.end() + count * _ROW.itemsize:
        raise ValueError(f"{path}: its length is not that of its header")
    rows = np.frombuffer(data, _ROW, count, head.end())
    return FrameContacts(
        points=_columns(rows, list(_AXES)),
        normals=_columns(rows, [f"n{axis}" for axis in _AXES]),
        gaps=rows["gap"].astype(np.float64),
        impulses=_columns(rows, [f"impulse_{axis}" for axis in _AXES]),
        weights=_columns(rows, [f"weight_{k}" for k in range(4)]),
        vertices=_columns(rows, [f"vertex_{k}" for k in range(4)]).astype(np.int32),
        kind=rows["kind"].astype(np.int32),
        bodies=_columns(rows, ["body_a", "body_b"]).astype(np.int32),
        dt=float(head[1]),
    )
