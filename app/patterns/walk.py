# SPDX-License-Identifier: Apache-2.0
"""A body that walks, for `drape sew`: a trunk and two legs, as one mesh and a point
cache of steps on the spot for 5 s, which begins with the body that stands.

usage: walk.py FOLDER [SECONDS]: writes body.ply and walk.pc2 there
"""

import math
import struct
import sys
from pathlib import Path

RATE = 60  # frames a second
PERIOD, RAMP = 1.1, 0.55  # s: of two steps; until they are as long as they get
THIGH, KNEE = 24, 40  # degrees that they turn, at most
AROUND = 32  # vertices around the trunk; the legs have half
HIP, LEG, SHIN = (0.09, 0.9, 0), 0.42, 0.4  # m
# Heights and radii of the trunk, m, between which it goes smoothly.
TRUNK = [(0.8, 0.1), (0.93, 0.17), (1.12, 0.115), (1.32, 0.145), (1.48, 0.05)]


def tube(rings, around):
    """Returns the vertices and triangles of a closed tube of rings (height, radius),
    with a vertex at either end."""
    x, tri = [], []
    for y, r in rings:
        for k in range(around):
            angle = 2 * math.pi * k / around
            x.append((r * math.cos(angle), y, r * math.sin(angle)))
    for ring in range(len(rings) - 1):
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            tri += [(a, a + around, b), (b, a + around, b + around)]
    for ring, far in ((0, -1), (len(rings) - 1, 1)):
        y, r = rings[ring]
        x.append((0, y + far * 0.5 * r, 0))
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            tri.append((a, b, len(x) - 1)[::-far])
    return x, tri


def smooth(profile, pieces):
    """Returns heights and radii with so many pieces between two of the profile."""
    out = [profile[0]]
    for (y0, r0), (y1, r1) in zip(profile, profile[1:]):
        for k in range(1, pieces + 1):
            t = k / pieces
            out.append((y0 + t * (y1 - y0), r0 + t * t * (3 - 2 * t) * (r1 - r0)))
    return out


def limb(length, top, bottom):
    """Returns the rings of a limb that hangs from 0, with round ends."""
    ends = [math.radians(a) for a in (75, 50, 25, 0)]
    rings = [(-length - bottom * math.sin(a), bottom * math.cos(a)) for a in ends]
    for k in range(1, 12):
        t = k / 12
        rings.append((-length * (1 - t), bottom + t * (top - bottom)))
    return rings + [(top * math.sin(a), top * math.cos(a)) for a in ends[::-1]]


def turned(points, degrees, at):
    """Returns points turned about x and moved; a positive angle lifts forward."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(x + at[0], c * y + s * z + at[1], c * z - s * y + at[2]) for x, y, z in points]


trunk = tube(smooth(TRUNK, 8), AROUND)
thigh = tube(limb(LEG, 0.082, 0.058), AROUND // 2)
shin = tube(limb(SHIN, 0.056, 0.042), AROUND // 2)
parts = [trunk, thigh, shin, thigh, shin]


def body(t):
    """Returns the vertices at a time."""
    size = min(t / RAMP, 1)
    size *= size * (3 - 2 * size)
    x = list(trunk[0])
    for side in (1, -1):
        phase = 2 * math.pi * t / PERIOD
        swing = side * size * THIGH * math.sin(phase)
        # the knee bends while its leg comes forward
        bend = size * KNEE * max(side * math.cos(phase), 0) ** 2
        at = (side * HIP[0], HIP[1], HIP[2])
        x += turned(thigh[0], swing, at)
        knee = turned([(0, -LEG, 0)], swing, at)[0]
        x += turned(shin[0], swing - bend, knee)
    return x


def main(folder, seconds=5):
    """Writes the mesh and its frames."""
    folder.mkdir(parents=True, exist_ok=True)
    frames = [body(k / RATE) for k in range(round(RATE * seconds) + 1)]
    tri, first = [], 0
    for x, faces in parts:
        tri += [tuple(first + v for v in face) for face in faces]
        first += len(x)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {first}\n"
    head += "".join(f"property float {c}\n" for c in "xyz")
    head += f"element face {len(tri)}\nproperty list uchar int vertex_indices\nend_header\n"
    data = [b"".join(struct.pack("<3f", *p) for p in x) for x in frames]
    faces = b"".join(struct.pack("<B3i", 3, *face) for face in tri)
    (folder / "body.ply").write_bytes(head.encode() + data[0] + faces)
    cache = struct.pack("<12siiffi", b"POINTCACHE2\0", 1, first, 0.0, 1.0, len(data))
    (folder / "walk.pc2").write_bytes(cache + b"".join(data))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(float, sys.argv[2:]))
