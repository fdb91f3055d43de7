# SPDX-License-Identifier: Apache-2.0
"""Checks the contacts of a run's frame without the tool; called by run.sh.

usage: contacts.py DIR FRAME   of a run of one step a frame: the points, and the
                               impulses that report.json tells of this step
"""
import json
import math
import os
import struct
import sys

from geometry import load

TYPES = {"double": "d", "int": "i"}


def read(path):
    """The properties' names, and the rows."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data.split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    names = [line[2] for line in lines if line[0] == "property"]
    row = struct.Struct("<" + "".join(
        TYPES[line[1]] for line in lines if line[0] == "property"))
    [count] = [int(line[2]) for line in lines if line[0] == "element"]
    assert len(body) == count * row.size, path
    return [dict(zip(names, values)) for values in row.iter_unpack(body)]


def positions(folder, frame):
    """Of all vertices, in the order of the scene; obstacles stand still."""
    cloth, _ = load(os.path.join(folder, "frames/cloth_%04d.ply" % frame))
    return cloth + load(os.path.join(folder, "obstacles.ply"))[0]


def check_place(row, then, now):
    """The point is that of side A at the end of the step, and the gap is the way
    between the sides along the normal at its beginning."""
    weights = [(row["vertex_%d" % k], row["weight_%d" % k]) for k in range(4)]
    ones = weights[:1 if row["kind"] == 0 else 2]
    for i, axis in enumerate("xyz"):
        place = sum(w * now[v][i] for v, w in ones)
        assert abs(place - row[axis]) < 1e-6, (axis, place, row)
    gap = sum(w * then[v][i] * row["n" + axis] for v, w in weights
              for i, axis in enumerate("xyz"))
    assert abs(gap - row["gap"]) < 1e-6, (gap, row)


def loose(rows, cloths):
    """N·s by which pairs may miss what the bodies got (control.md §8.2): what pair k
    bears is what its vertices got along its own normal. Where another pair of the same
    vertex has a normal at an angle α, that is off by sin α of it."""
    normal = [tuple(row["n" + axis] for axis in "xyz") for row in rows]
    at = {}
    for k, row in enumerate(rows):
        for j in range(4):
            side = j >= (1 if row["kind"] == 0 else 2)
            if cloths[(row["body_a"], row["body_b"])[side]]:
                at.setdefault(row["vertex_%d" % j], []).append(k)
    widest = [0.0] * len(rows)
    for ks in at.values():
        for k in ks:
            cosines = [abs(sum(map(float.__mul__, normal[k], normal[m]))) for m in ks]
            sine = math.sqrt(max(0, 1 - min(cosines) ** 2))
            widest[k] = max(widest[k], sine)
    return sum(sine * math.hypot(*(row["impulse_" + axis] for axis in "xyz"))
               for sine, row in zip(widest, rows))


def main(folder, frame):
    with open(os.path.join(folder, "report.json")) as file:
        report = json.load(file)
    name = "frames/contacts_%04d.ply"
    assert not read(os.path.join(folder, name % 0)), "contacts at the start"
    rows = read(os.path.join(folder, name % frame))
    step = report["steps"][frame - 1]
    told = step["impulses"]["bodies"]
    assert len(rows) == step["contacts"] > 0, (len(rows), step["contacts"])
    assert 0 < step["impulses"]["slice"] <= report["dt"] * (1 + 1e-12)
    assert len(told) == len(report["bodies"])
    sums = [[0.0, 0.0, 0.0] for _ in report["bodies"]]
    then, now = positions(folder, frame - 1), positions(folder, frame)
    for row in rows:
        check_place(row, then, now)
        length = sum(row["n" + axis] ** 2 for axis in "xyz")
        assert abs(length - 1) < 1e-6, row
        assert abs(sum(row["weight_%d" % k] for k in range(4))) < 1e-6, row
        bodies = row["body_a"], row["body_b"]
        for k, vertex in enumerate(row["vertex_%d" % k] for k in range(4)):
            side = k >= (1 if row["kind"] == 0 else 2)
            first = [b["first_vertex"] for b in report["bodies"]]
            first.append(report["vertices"])
            at = bodies[side]
            assert first[at] <= vertex < first[at + 1], row
        for i, axis in enumerate("xyz"):
            sums[bodies[0]][i] += row["impulse_" + axis]
            sums[bodies[1]][i] -= row["impulse_" + axis]
    most = max(abs(a) for body in told for a in body)
    assert most > 0
    # what a cloth got is not the sum of its pairs alone (control.md §8.3)
    assert all(abs(sum(axis)) <= 1e-12 * most for axis in zip(*told))
    off = loose(rows, [body["kind"] == "cloth" for body in report["bodies"]])
    assert off < most, (off, most)
    for body, mine, his in zip(report["bodies"], sums, told):
        for a, b in zip(mine, his):
            assert body["kind"] == "cloth" or abs(a - b) <= off + 1e-6 * most


main(sys.argv[1], int(sys.argv[2]))
