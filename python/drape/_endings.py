# SPDX-License-Identifier: Apache-2.0
"""Endings of files of meshes: of those that are read, and of those that are written.
It imports nothing, so that the command line can ask before anything is loaded."""

USD, ALEMBIC, NUMPY = (".usd", ".usda", ".usdc", ".usdz"), (".abc",), (".npz",)
# What is read: by Python alone, and by the tool as well (app/read/mesh.c).
PYTHONS = (*USD, *ALEMBIC, *NUMPY)
TOOLS = (".ply", ".off", ".obj", ".stl", ".gltf", ".glb", ".dae", ".fbx")
# What is written with one frame a file.
FRAME = (".ply", ".obj", ".off", ".stl", ".vtk", ".vtu")
