# SPDX-License-Identifier: Apache-2.0
"""Turns the public files of Scalable CCD into those that the tests read.

usage: data.py hits T0.ply FOLDER     prints `vf v f0 f1 f2`, `ee a0 a1 b0 b1`:
                                      every pair of primitives that touches
       data.py column QUERIES TRUTH   prints the queries with their truth as a
                                      seventh column

FOLDER holds vf-boxes, vf-truth, ee-boxes and ee-truth, which are JSON: pairs of
box numbers, and whether the primitives in these boxes touch. Boxes are numbered
vertices first, then edges by their second and first vertex, then faces.
"""
import json
import os
import struct
import sys

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i",
         "uint": "I", "float": "f", "double": "d"}


def read_ply(path):
    """The number of vertices, and the triangles."""
    with open(path, "rb") as file:
        counts, rows, order = {}, {}, "<"
        for line in iter(file.readline, b"end_header\n"):
            words = line.decode().split()
            if words[0] == "format":
                order = "<" if "little" in words[1] else ">"
            elif words[0] == "element":
                name = words[1]
                counts[name], rows[name] = int(words[2]), []
            elif words[0] == "property":
                rows[name].append(words[1:])
        vertex = order + "".join(TYPES[row[0]] for row in rows["vertex"])
        file.seek(struct.calcsize(vertex) * counts["vertex"], os.SEEK_CUR)
        face = struct.Struct(order + TYPES[rows["face"][0][1]] + "3i")
        faces = [face.unpack(file.read(face.size))
                 for _ in range(counts["face"])]
    assert all(f[0] == 3 for f in faces), "not a mesh of triangles"
    return counts["vertex"], [f[1:] for f in faces]


def hits(mesh, folder):
    vertices, faces = read_ply(mesh)
    edges = sorted({tuple(sorted((f[k], f[k - 1])))
                    for f in faces for k in range(3)}, key=lambda e: e[::-1])
    boxes = [(v,) for v in range(vertices)] + edges + faces
    for kind in ("vf", "ee"):
        with open(os.path.join(folder, kind + "-boxes")) as file:
            pairs = json.load(file)
        with open(os.path.join(folder, kind + "-truth")) as file:
            truth = json.load(file)
        assert len(pairs) == len(truth), "as many answers as pairs"
        for pair, touch in zip(pairs, truth):
            if touch:
                a, b = sorted((boxes[k] for k in pair), key=len)
                assert (len(a), len(b)) == ((1, 3) if kind == "vf" else (2, 2))
                print(kind, *a, *b)


def column(queries, answers):
    with open(answers) as file:
        truth = json.load(file)
    with open(queries) as file:
        rows = [line.strip() for line in file if line.strip()]
    assert len(rows) == 8 * len(truth), "eight rows a query"
    for k, row in enumerate(rows):
        print(f"{row},{int(truth[k // 8])}")


{"hits": hits, "column": column}[sys.argv[1]](*sys.argv[2:])
