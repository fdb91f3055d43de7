# SPDX-License-Identifier: Apache-2.0
"""Checks the meshes that the tool makes of shapes, starts, placements, holes and
pins against formulas that are written here (app/scenes/README.md).

usage: geometry.py write FILE        the scene, and its mesh corner.off
       geometry.py check DIR         its run of two frames in binary64
       geometry.py converted FILE    the mesh, converted with --up and --size
Fails with a line that names the body.
"""
import json
import math
import struct
import sys

EPS = 1e-12
AROUND = 28
KEYS = {"up": [1, 2, -1], "size": 3, "scale": 0.5, "axis": [2, -1, 3],
        "angle": 130, "at": [50, 2, 1]}
CORNERS = [(0, 0, 0), (2, 0, 0), (0, 1, 0), (0.5, 0.25, 3)]
PATCH = {"disc": [0.31, 0.22, 0.12], "rect": [0.5, 0.1, 0.7, 0.3]}
ROLL = {"radius": 0.06, "gap": 0.02}
FOLD = {"folds": 3, "depth": 0.05}


def write(path):
    with open("corner.off", "w") as file:
        file.write("OFF\n4 4 0\n" + "".join("%r %r %r\n" % c for c in CORNERS) +
                   "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
    def sheet(name, far, start, **more):
        return {"name": name, "particles": [41, 21], "size": [1, 0.5],
                "start": {"at": [0, far, 0], **start}, **more}
    pins = [{"edge": "u1", "every": 0.11}, {"edge": "v0"},
            {"at": [0.26, 0.24]}, {"at": [0.99, 0.49], "motion": "away"},
            {"at": [0.74, 0.24], "motion": "away"}]
    cloths = [
        sheet("flat", 10, {"u": [1, 1, 0], "v": [1, 0, 3]}, velocity=[1, 2, 3]),
        sheet("hung", 20, {"shape": "hung"}, velocity=[0, 2, 0]),
        sheet("slanted", 90, {"shape": "hung", "v": [0, -3, 4]}, velocity=[0, 0, 3]),
        sheet("folded", 30, {"shape": "hung", **FOLD}),
        sheet("rolled", 40, {"shape": "rolled", "u": [0, 1, 0], **ROLL}),
        sheet("holes", 50, {}, holes=[PATCH]),
        sheet("cuts", 60, {}, cuts=[PATCH]),
        sheet("pins", 70, {}, pins=pins),
        sheet("edges", 80, {}, pins=[
            {"edge": "u0"}, {"edge": "v1", "every": 0.05}])]
    round_shapes = [
        {"shape": "sphere", "radius": 0.7},
        {"shape": "capsule", "radius": 0.3, "length": 1.5},
        {"shape": "funnel", "radius": 0.8, "throat": 0.2, "height": 0.9,
         "length": 0.4},
        {"shape": "statue", "height": 1.7}]
    shapes = [{"shape": "plane", "extent": [2, 1, 3]},
              {"shape": "box", "extent": [1, 2, 3]}]
    shapes += [{"detail": AROUND, **s} for s in round_shapes]
    for k, shape in enumerate(shapes):
        shape.update(name=shape["shape"], at=[9 * k - 30, -9, 0])
    placed = {"mesh": "corner.off", "name": "placed", "stand": True, **KEYS}
    with open(path, "w") as file:
        json.dump({"frames": 2, "precision": 64, "cloths": cloths,
                   "obstacles": shapes + [placed], "sleep": False,
                   "motions": [{"name": "away", "keys": [
                       {"time": 0}, {"time": 1, "move": [0, 1, 0]}]}]}, file)


def parse(data, number=None):
    """Vertices and triangles of a binary PLY's bytes; number: "d" or "f", of which the
    vertices must be."""
    head, body = data.split(b"end_header\n", 1)
    nv = int(head.split(b"element vertex ")[1].split()[0])
    size, found = (24, "d") if b"double x" in head else (12, "f")
    assert number in (None, found), (number, found)
    x = list(struct.iter_unpack("<3" + found, body[:size * nv]))
    return x, [t[1:] for t in struct.iter_unpack("<B3i", body[size * nv:])]


def load(path, number=None):
    """The same of a file."""
    with open(path, "rb") as file:
        return parse(file.read(), number)


def bodies(run, kind, frame):
    """name: (vertices, triangles) of each body of this kind."""
    with open(run + "/report.json") as file:
        rows = [b for b in json.load(file)["bodies"] if b["kind"] == kind]
    x, tri = load(run + "/" + frame)
    first = rows[0]["first_vertex"], rows[0]["first_triangle"]
    at = [(b["first_vertex"] - first[0], b["first_triangle"] - first[1])
          for b in rows] + [(len(x), len(tri))]
    return {b["name"]: (x[at[k][0]:at[k + 1][0]],
                        [[v - at[k][0] for v in t]
                         for t in tri[at[k][1]:at[k + 1][1]]])
            for k, b in enumerate(rows)}


def near(a, b, eps=EPS):
    assert math.dist(a, b) <= eps, (a, b, math.dist(a, b))


def close(a, b, eps=EPS):
    assert abs(a - b) <= eps, (a, b)


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [v / math.hypot(*a) for v in a]


# Obstacles

def borders(mesh):
    """How many edges have one triangle; no triangle is flat, and no edge has
    more than two or two of one direction."""
    x, tri = mesh
    seen = {(a, b) for t in tri for a, b in zip(t, t[1:] + t[:1])}
    assert len(seen) == 3 * len(tri), "an edge twice"
    for t in tri:
        p, q, r = (x[v] for v in t)
        assert math.hypot(*cross(minus(q, p), minus(r, p))) > 1e-9, "flat"
    assert {v for t in tri for v in t} == set(range(len(x))), "a loose vertex"
    return sum((b, a) not in seen for a, b in seen)


def volume(mesh):
    x, tri = mesh
    return sum(dot(x[a], cross(x[b], x[c])) for a, b, c in tri) / 6


def moved(mesh, k):
    x, tri = mesh
    return [minus(p, [9 * k - 30, -9, 0]) for p in x], tri


def check_plane(mesh):
    x, tri = mesh
    assert sorted(x) == [[a, 0, b] for a in (-1, 1) for b in (-1.5, 1.5)]
    up = [0, 0, 0]
    for a, b, c in tri:
        n = cross(minus(x[b], x[a]), minus(x[c], x[a]))
        up = [u + v / 2 for u, v in zip(up, n)]
    assert up == [0, 6, 0] and len(tri) == 2 and borders(mesh) == 4


def check_box(mesh):
    assert sorted(mesh[0]) == [[a, b, c] for a in (-.5, .5) for b in (-1, 1)
                               for c in (-1.5, 1.5)]
    assert len(mesh[1]) == 12 and borders(mesh) == 0
    close(volume(mesh), 6)


def rings(mesh):
    """Rings of vertices but for poles; on a ring vertices are evenly spaced, from
    the x axis on and towards z."""
    x = [p for p in mesh[0] if p[0] or p[2]]
    assert len(x) % AROUND == 0
    for j, p in enumerate(x):
        turn = 2 * math.pi * (j % AROUND) / AROUND
        r = math.hypot(p[0], p[2])
        near(p, [r * math.cos(turn), p[1], r * math.sin(turn)], 1e-13)
    return [x[k:k + AROUND] for k in range(0, len(x), AROUND)]


def check_capsule(mesh, radius, length):
    steps = AROUND // 4
    count = 2 * steps - (0 if length else 1)
    assert len(rings(mesh)) == count and borders(mesh) == 0
    assert len(mesh[0]) == 2 + AROUND * count
    for x, y, z in mesh[0]:
        beyond = max(abs(y) - length / 2, 0)
        close(math.hypot(x, beyond, z), radius)
        step = math.atan2(beyond, math.hypot(x, z)) / (math.pi / 2) * steps
        close(step, round(step), 1e-9)
    whole = math.pi * radius ** 2 * (length + 4 / 3 * radius)
    assert 0.96 * whole < volume(mesh) < whole, (volume(mesh), whole)


def check_funnel(mesh):
    rows = rings(mesh)
    assert len(rows) == 23 and borders(mesh) == 2 * AROUND
    near([rows[0][0][1], rows[-1][0][1]], [-0.4, 0.9])
    for x, y, z in mesh[0]:
        close(math.hypot(x, z), 0.2 + max(y, 0) / 0.9 * 0.6)
    assert volume(mesh) > 0


def check_statue(mesh):
    """Fluted in sevenths: a seventh of a turn leaves the statue as it is, and no
    smaller turn does."""
    assert borders(mesh) == 0 and 0 < volume(mesh) < math.pi * 0.51 ** 2 * 1.7
    rows = [[math.hypot(p[0], p[2]) for p in row] for row in rings(mesh)]
    heights = [p[1] for p in mesh[0]]
    close(min(heights), 0, 0.01)  # a spline may swing beyond its knots
    close(max(heights), 1.7)
    close(max(r for row in rows for r in row) / 1.7, 0.3, 0.02)
    waves = 0
    for row in rows:
        for j, r in enumerate(row):
            close(r, row[(j + AROUND // 7) % AROUND])
        waves += max(row) - min(row) > 0.02 * max(row)
        close(max(row), max(row[0], row[2]))
    assert waves > 20, waves


def turned(x, axis, degrees):
    """Rodrigues."""
    k, a = unit(axis), math.radians(degrees)
    c, s = math.cos(a), math.sin(a)
    return [x[i] * c + cross(k, x)[i] * s + k[i] * dot(k, x) * (1 - c)
            for i in range(3)]


def stood(scale):
    """The mesh, levelled, as large as it says times a scale, and on y = 0."""
    up = unit(KEYS["up"])
    angle = math.degrees(math.acos(up[1]))
    x = [turned(c, cross(up, [0, 1, 0]), angle) for c in CORNERS]
    spans = [[min(p[i] for p in x), max(p[i] for p in x)] for i in range(3)]
    factor = scale * KEYS["size"] / max(b - a for a, b in spans)
    foot = [sum(spans[0]) / 2, spans[1][0], sum(spans[2]) / 2]
    return [[factor * v for v in minus(p, foot)] for p in x]


def check_placed(mesh):
    assert len(mesh[0]) == len(mesh[1]) == len(CORNERS)
    for p, q in zip(stood(KEYS["scale"]), mesh[0]):
        p = turned(p, KEYS["axis"], KEYS["angle"])
        near([a + b for a, b in zip(p, KEYS["at"])], q)


def check_converted(mesh):
    assert len(mesh[0]) == len(mesh[1]) == len(CORNERS)
    for p, q in zip(stood(1), mesh[0]):
        near(p, q, 1e-6)


# Cloths: 41 × 21 particles, 25 mm apart

M, N, CELL = 41, 21, 0.025


def check_even(x):
    """Neighbours are a cell apart in both directions."""
    for k, p in enumerate(x):
        if k % M:
            close(math.dist(p, x[k - 1]), CELL, 1e-11)
        if k >= M:
            close(math.dist(p, x[k - M]), CELL, 1e-11)


def check_flat(x, after):
    u = unit([1, 1, 0])
    v = unit(minus([1, 0, 3], [dot([1, 0, 3], u) * e for e in u]))
    for k, p in enumerate(x):
        a, b = CELL * (k % M) - 0.5, CELL * (k // M) - 0.25
        near([a * u[i] + b * v[i] + [0, 10, 0][i] for i in range(3)], p)
    check_fall(x, after, [1, 2, 3])


def check_fall(x, after, v):
    """1/60 s later the middle went by its velocity, and it fell."""
    way = minus(after[420], x[420])
    near([60 * way[0], 60 * way[2]], [v[0], v[2]], 1e-6)
    close(60 * way[1], v[1] - 9.81 / 60, 0.09)


def check_hung(x, after):
    for k, p in enumerate(x):
        near(p, [CELL * (k % M) - 0.5, 20 - CELL * (k // M), 0])
    check_fall(x, after, [0, 2, 0])


def check_slanted(x, after):
    """Hung by the middle of its edge v0, too."""
    for k, p in enumerate(x):
        down = CELL * (k // M)
        near(p, [CELL * (k % M) - 0.5, 90 - 0.6 * down, 0.8 * down])
    check_fall(x, after, [0, 0, 3])


def arc(wave):
    """The length of one wave of this fold, by Simpson's rule."""
    steep = 2 * math.pi * FOLD["depth"] / wave
    f = [math.hypot(1, steep * math.cos(2 * math.pi * k / 400))
         for k in range(401)]
    return wave / 1200 * (f[0] + f[-1] + 4 * sum(f[1:-1:2]) + 2 * sum(f[2:-1:2]))


def check_folded(x):
    """On a sine of which a wave takes a third of the sheet's metre; u × v is -z.
    """
    lo, hi = 0.01, 1
    for _ in range(60):
        wave = (lo + hi) / 2
        lo, hi = (lo, wave) if arc(wave) > 1 / FOLD["folds"] else (wave, hi)
    for k, p in enumerate(x):
        turn = 2 * math.pi * (p[0] - x[0][0]) / wave
        near(p, [x[k % M][0], 30 - CELL * (k // M),
                 -FOLD["depth"] * math.sin(turn)], 1e-4)
    close(x[0][0], -x[M - 1][0])


def check_rolled(x):
    """u is y, v is z: w = u × v is x."""
    turn, last = 0, 0
    for k in range(M):
        angle = math.atan2(x[k][0], x[k][1] - 40) / (2 * math.pi)
        turn += (angle - last) % 1
        last = angle
        r = math.hypot(x[k][0], x[k][1] - 40)
        close(r, ROLL["radius"] + ROLL["gap"] * turn, 1e-11)
    assert 1.5 < turn < 3, turn
    for k, p in enumerate(x):
        near(p, [*x[k % M][:2], CELL * (k // M) - 0.25])


def within(a, b):
    d, r = PATCH["disc"], PATCH["rect"]
    return math.hypot(a - d[0], b - d[1]) <= d[2] or \
        r[0] <= a <= r[2] and r[1] <= b <= r[3]


def check_cells(tri, is_gone):
    """Two triangles in each cell that is there, and none in another."""
    count = {}
    for t in tri:
        cell = min(v % M for v in t), min(v // M for v in t)
        count[cell] = count.get(cell, 0) + 1
    assert count == {(i, j): 2 for i in range(M - 1) for j in range(N - 1)
                     if not is_gone(i, j)}, "cells"
    assert 0.7 * 800 < len(count) < 0.95 * 800


def holed(i, j):
    return any(within(CELL * (i + a), CELL * (j + b))
               for a in (0, 1) for b in (0, 1))


def cut(i, j):
    return within(CELL * (i + 0.5), CELL * (j + 0.5))


def check_pins(x, after, held, led=()):
    for k, (p, q) in enumerate(zip(x, after)):
        at = k % M, k // M
        if at in led:
            near(q, [p[0], p[1] + 1 / 60, p[2]], 1e-9)
        else:
            assert (p == q) == (at in held), at


def check(run):
    still = bodies(run, "obstacle", "obstacles.ply")
    order = ["plane", "box", "sphere", "capsule", "funnel", "statue"]
    assert list(still) == order + ["placed"]
    mesh = {name: moved(still[name], k) for k, name in enumerate(order)}
    check_plane(mesh["plane"])
    check_box(mesh["box"])
    check_capsule(mesh["sphere"], 0.7, 0)
    check_capsule(mesh["capsule"], 0.3, 1.5)
    check_funnel(mesh["funnel"])
    check_statue(mesh["statue"])
    check_placed(still["placed"])
    start = bodies(run, "cloth", "frames/cloth_0000.ply")
    first = bodies(run, "cloth", "frames/cloth_0001.ply")
    for name in start:
        check_even(start[name][0])
    check_flat(start["flat"][0], first["flat"][0])
    check_hung(start["hung"][0], first["hung"][0])
    check_slanted(start["slanted"][0], first["slanted"][0])
    check_folded(start["folded"][0])
    check_rolled(start["rolled"][0])
    check_cells(start["holes"][1], holed)
    check_cells(start["cuts"][1], cut)
    # 0.11 m are four cells and a half, of which five come next
    ends = {(40, j) for j in [*range(0, N, 4), N - 1]}
    check_pins(start["pins"][0], first["pins"][0],
               ends | {(i, 0) for i in range(M)} | {(10, 10)}, {(30, 10)})
    check_pins(start["edges"][0], first["edges"][0],
               {(0, j) for j in range(N)} | {(i, N - 1) for i in range(0, M, 2)})


def main():
    if sys.argv[1] == "write":
        write(sys.argv[2])
    elif sys.argv[1] == "converted":
        check_converted(load(sys.argv[2]))
    else:
        check(sys.argv[2])


if __name__ == "__main__":
    main()
