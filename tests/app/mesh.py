# SPDX-License-Identifier: Apache-2.0
"""Whether two binary PLY files of the tool hold the same triangles.

usage: mesh.py A.ply B.ply    the same triangles in the same order, corners in
                              any cyclic order and within 1e-5 m
Fails with a line that names the first other triangle.
"""
import struct
import sys


def load(path):
    """The triangles as tuples of three corners."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    count = {line.split()[1]: int(line.split()[2])
             for line in head.decode().splitlines() if line[:7] == "element"}
    x = list(struct.iter_unpack("<3f", body[:12 * count["vertex"]]))
    faces = struct.iter_unpack("<B3i", body[12 * count["vertex"]:])
    return [tuple(x[v] for v in face[1:]) for face in faces]


def near(a, b):
    return any(all(abs(p - q) <= 1e-5 for k in range(3)
                   for p, q in zip(a[k], b[(k + turn) % 3]))
               for turn in range(3))


one, other = load(sys.argv[1]), load(sys.argv[2])
if not one or len(one) != len(other):
    sys.exit(f"{len(one)} and {len(other)} triangles")
for number, pair in enumerate(zip(one, other)):
    if not near(*pair):
        sys.exit(f"triangle {number}: {pair[0]} and {pair[1]}")
