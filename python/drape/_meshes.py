# SPDX-License-Identifier: Apache-2.0
"""Arrays and meshes of other packages, taken as they are."""

from __future__ import annotations

import reprlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError


def on_host(value: Any) -> NDArray[Any]:
    """Returns what NumPy reads of an array: torch's with gradients or on a device,
    CuPy's and Warp's on a device, and whatever else NumPy takes."""
    if hasattr(value, "detach"):
        value = value.detach().cpu()
    elif hasattr(value, "__cuda_array_interface__"):
        for name in ("get", "numpy"):
            if hasattr(value, name):
                value = getattr(value, name)()
                break
    return np.asarray(value)


def are_of(tri: NDArray[Any], count: int) -> bool:
    """Whether triangles are of vertices 0 to count - 1."""
    return bool(((tri >= 0) & (tri < count)).all())


def ply(x: NDArray[Any], tri: NDArray[Any]) -> bytes:
    """Returns a mesh as a binary PLY, which keeps every bit: vertices [n, 3] m of 32
    or 64 bits, triangles [k, 3]."""
    kind, size = ("float", "<f4") if x.dtype == np.float32 else ("double", "<f8")
    face = np.dtype([("count", "u1"), ("vertices", "<i4", 3)])
    rows = np.empty(len(tri), face)
    rows["count"], rows["vertices"] = 3, tri
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(x)}\n"
    head += "".join(f"property {kind} {axis}\n" for axis in "xyz")
    head += f"element face {len(tri)}\nproperty list uchar int vertex_indices\n"
    points = np.ascontiguousarray(x, size).tobytes()
    return (head + "end_header\n").encode() + points + rows.tobytes()


def same(a: Any, b: Any) -> bool:
    """Whether two arrays have the same shape and numbers."""
    try:
        return np.array_equal(on_host(a), on_host(b))
    except ValueError:  # a list of lists of different lengths
        return False


def mesh_of(mesh: Any, where: str) -> tuple[Any, Any]:
    """Returns the vertices and the triangles of a mesh: of a pair of them; of an
    object of trimesh, pyvista, Open3D or meshio."""
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1]
    if hasattr(mesh, "geometry") and hasattr(mesh, "to_mesh"):
        mesh = mesh.to_mesh()  # a scene of trimesh
    if hasattr(mesh, "triangulate") and hasattr(mesh, "faces"):
        mesh = mesh.triangulate()  # a surface of pyvista
        return mesh.points, np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
    for name in ("faces", "triangles"):
        if hasattr(mesh, "vertices") and hasattr(mesh, name):
            return mesh.vertices, getattr(mesh, name)
    cells = getattr(mesh, "cells_dict", None)
    if cells and "triangle" in cells:
        return mesh.points, cells["triangle"]
    raise SceneError(
        f"{where}: {reprlib.repr(mesh)} is no mesh; expected the path of a file, "
        "vertices and triangles as a pair (vertices, triangles), or an object of "
        "trimesh, pyvista (a surface), Open3D or meshio that has both"
    )
