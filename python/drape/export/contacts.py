# SPDX-License-Identifier: Apache-2.0
"""Reads the contacts of a run's frame, which `drape run --contacts` writes: a PLY
of points, which plyfile, meshio and others read, too."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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
class FrameContacts:
    """The pairs in contact in the last slice of a frame's last step, sides A and B:
    a vertex and a face, or two edges."""

    points: NDArray[np.float64]
    """[n, 3] m, on side A."""
    normals: NDArray[np.float64]
    """[n, 3] of length 1, from B to A."""
    gaps: NDArray[np.float64]
    """[n] m, along the normal, at the start of the slice."""
    impulses: NDArray[np.float64]
    """[n, 3] N·s, that A got from B, with friction."""
    weights: NDArray[np.float64]
    """[n, 4] those of A add to 1, those of B to -1."""
    vertices: NDArray[np.int32]
    """[n, 4] of the scene: A's, then B's."""
    kind: NDArray[np.int32]
    """[n] 0: A is a vertex and B a face, 1: both are edges."""
    bodies: NDArray[np.int32]
    """[n, 2] numbers of A's and of B's body in the report's list."""
    dt: float
    """s, length of the slice: an impulse divided by it is the mean force."""

    def __len__(self) -> int:
        """How many pairs there are."""
        return len(self.kind)


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
