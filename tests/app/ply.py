# SPDX-License-Identifier: Apache-2.0
"""One mesh in all forms that PLY has: text and bytes of both orders, each type of
numbers and of list lengths, and elements and properties that no mesh needs.

usage: ply.py DRAPE
Fails with a line that names the file which is not read as the mesh.
"""
import struct
import subprocess
import sys

from geometry import parse

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i",
         "uint": "I", "float": "f", "double": "d", "int8": "b", "uint8": "B",
         "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
         "float32": "f", "float64": "d"}
FORMS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
X = [(0, 0, 0), (3, 0, 1), (2, 5, 0), (0, 4, 9), (7, 7, 7)]
FACES = [[0, 1, 2, 3], [4, 0, 1], [1, 2]]  # the last has no triangle
WHOLE = ["char", "uchar", "short", "ushort", "int", "uint"]


def put(form, name, value):
    if FORMS[form] is None:
        return b"%r " % value
    kind = TYPES[name]
    return struct.pack(FORMS[form] + kind, value if kind in "fd" else int(value))


def make(path, form, x, coordinate, length, index, more=False):
    """The mesh with these types; more: what a reader has to pass over."""
    head = ["ply", "format %s 1.0" % form, "comment made by a test"]
    body = b""
    if more:
        head += ["element strip 2", "property short a",
                 "property list uchar double b"]
        for k in range(2):
            body += put(form, "short", -9) + put(form, "uchar", k)
            body += k * put(form, "double", 0.5)
    head += ["element vertex %d" % len(x)]
    head += ["property list short char xs"] if more else []
    head += ["property %s %s" % (coordinate, axis) for axis in "xyz"]
    head += ["property uchar xx"] if more else []
    for p in x:
        body += put(form, "short", 2) + 2 * put(form, "char", -7) if more else b""
        body += b"".join(put(form, coordinate, v) for v in p)
        body += put(form, "uchar", 200) if more else b""
    head += ["element face %d" % len(FACES)]
    head += ["property uint flags"] if more else []
    head += ["property list %s %s vertex_index" % (length, index)]
    head += ["property list ushort float t"] if more else []
    for face in FACES:
        body += put(form, "uint", 2 ** 32 - 1) if more else b""
        body += put(form, length, len(face))
        body += b"".join(put(form, index, v) for v in face)
        body += put(form, "ushort", 1) + put(form, "float", 1.5) if more else b""
    head += ["element last 0", "property double e"] if more else []
    with open(path, "wb") as file:
        file.write("\n".join(head + ["end_header", ""]).encode() + body)


def read(drape, path):
    """What the tool makes of it: the vertices and triangles of PLY."""
    done = subprocess.run([drape, "convert", path, "-"], capture_output=True)
    assert done.returncode == 0, (path, done.stderr)
    return parse(done.stdout)


def stood(x):
    """Convert sets a mesh on y = 0, in the middle of x and z."""
    lo, hi = ([f(p[i] for p in x) for i in range(3)] for f in (min, max))
    by = [(lo[0] + hi[0]) / 2, lo[1], (lo[2] + hi[2]) / 2]
    return [tuple(a - b for a, b in zip(p, by)) for p in x]


def check(drape, form, *types, x=X, more=False):
    make("form.ply", form, x, *types, more=more)
    got, tri = read(drape, "form.ply")
    assert tri == [(0, 1, 2), (0, 2, 3), (4, 0, 1)], (form, types, tri)
    assert got == stood(x), (form, types, got)


def polygon(drape, length, corners):
    """A fan of that many corners: the exit status of convert."""
    with open("fan.ply", "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 1\n"
                   "property list %s int vertex_indices\nend_header\n" %
                   (corners, length))
        file.writelines("%d %d 0\n" % (k, k * k) for k in range(corners))
        file.write(" ".join(map(str, [corners, *range(corners)])) + "\n \t\r\n")
    return subprocess.run([drape, "convert", "fan.ply", "fan_3.ply"],
                          capture_output=True).returncode


def main():
    drape = sys.argv[1]
    # numbers at the ends of their types: what is lost of a sign would show
    for form in FORMS:
        for name, kind in TYPES.items():
            bits = 8 * struct.calcsize("=" + kind)
            signed = kind in "bhifd"
            most = 2 ** (min(bits, 24) - signed) - 1  # floats have 24 bits
            lift = [tuple(v - 60 * signed for v in p) for p in X[:4]]
            far = [*lift, (most, -most if signed else most, most)]
            check(drape, form, name, "uchar", "int", x=far)
        for name in WHOLE:
            check(drape, form, "float", name, name)
            check(drape, form, "double", name, "double", more=True)
    for length, most in (("char", 127), ("uchar", 255), ("short", 32767)):
        assert polygon(drape, length, most) == 0, length
        assert polygon(drape, length, most + 1) == 2, length


main()
