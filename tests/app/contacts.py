# SPDX-License-Identifier: Apache-2.0
"""Checks the contacts of a run's frame without the tool; called by run.sh.

usage: contacts.py DIR FRAME   of a run of one step a frame: the points, and the
                               impulses that report.json tells of this step
"""
import json
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
    # what a cloth got is not the sum of its pairs alone (control.md §8.3), and where
    # a vertex has contacts of several normals pairs need not add up (control.md §8.2)
    assert all(abs(sum(axis)) <= 1e-12 * most for axis in zip(*told))
    for body, mine, his in zip(report["bodies"], sums, told):
        for a, b in zip(mine, his):
            assert body["kind"] == "cloth" or abs(a - b) <= 0.03 * most


main(sys.argv[1], int(sys.argv[2]))
