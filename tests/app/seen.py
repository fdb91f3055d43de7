# SPDX-License-Identifier: Apache-2.0
"""What `drape render` takes from a run's report.json, and what it refuses there.

usage: seen.py DRAPE DIR    a run of one cloth, one obstacle and frame 0
Fails with a line that names the place and the value.
"""
import json
import os
import subprocess
import sys

CLOTH = ("$.bodies[0]: expected a cloth's first_vertex, particles and size, "
         "and a look")
STONE = "$.bodies[1]: expected an obstacle's first_triangle, and a look"
CAMERA = "$.camera: expected eye, target and fov"
PICTURE = "$.picture: expected fov, turn, light, sun and floor"
TIME = "$.dt: expected a time between two frames"
INF, NONE = 1e308, object()
# Place, the greatest and the least value there, values beyond them, and words.
RANGES = [
    ("bodies 0 first_vertex", (0, 2 ** 31 - 1), (-1, 2 ** 31, NONE, "0"), CLOTH),
    ("bodies 0 particles 0", (2, 32768), (1, 32769, None), CLOTH),
    ("bodies 0 particles 1", (2, 32768), (1, 32769, True), CLOTH),
    ("bodies 0 size 0", (0, 1e9), (-1e-9, 1.1e9, "1"), CLOTH),
    ("bodies 0 size 1", (0, 1e9), (-1e-9, 1.1e9, []), CLOTH),
    ("bodies 0 size", (), (NONE, [1], 1), CLOTH),
    ("bodies 1 first_triangle", (0, 2 ** 31 - 1), (-1, 2 ** 31, NONE), STONE),
    ("camera eye 0", (-1e6, 1e6), (-1e7, 1e7, INF), CAMERA),
    ("camera eye 2", (-1e6, 1e6), (-1e7, 1e7, None), CAMERA),
    ("camera target 1", (-1e6, 1e6), (-1e7, 1e7, "0"), CAMERA),
    ("camera target", (), (NONE, [0, 0], 0), CAMERA),
    ("camera fov", (1, 150), (-1, 151, NONE), CAMERA),
    ("picture fov", (1, 150), (-1, 151, NONE), PICTURE),
    ("picture turn", (-3600, 3600), (-3601, 3601, NONE), PICTURE),
    ("picture light", (0, 10), (-0.1, 10.1, NONE), PICTURE),
    ("picture sun 0", (-1e6, 1e6), (-1e7, 1e7), PICTURE),
    ("picture sun", (), (NONE, [0, 1], 0), PICTURE),
    ("picture floor 2", (0, 1), (-0.1, 1.1), PICTURE),
    ("picture floor", (), (NONE, [0, 1], "0"), PICTURE),
    ("dt", (1, 1e-8), (0, -1, 1e-10, 1e9), TIME),
    ("steps_per_frame", (1, 1000), (0, -1), TIME)]
for body, words in (0, CLOTH), (1, STONE):
    look = "bodies %d look " % body
    RANGES += [(look + "gloss", (0, 1, NONE), (-0.1, 1.1, "1", None), words)]
    for side in ("colour", "inside"):
        RANGES += [(look + side, ([0, 0, 0], [1, 1, 1], NONE),
                    ([0, 1], [0, 0, 1, 1], [0, 0, 2], [0, -1, 0], [0, "1", 0], 5),
                    words)]


def put(report, place, value):
    """A copy of the report with this value, or without this key."""
    copy = json.loads(json.dumps(report))
    *way, last = [int(k) if k.isdigit() else k for k in place.split()]
    node = copy
    for k in way:
        node = node[k]
    if value is NONE:
        node.pop(last, None)
    else:
        node[last] = value
    return copy


def render(drape, folder, report):
    with open(os.path.join(folder, "report.json"), "w") as file:
        file.write(json.dumps(report))
    return subprocess.run([drape, "render", folder, "--frame", "0", "--width", "16",
                           "--height", "16", "--samples", "1"],
                          capture_output=True, text=True)


def main():
    drape, folder = sys.argv[1:]
    with open(os.path.join(folder, "report.json")) as file:
        report = json.load(file)
    report["camera"] = {"eye": [1, 1, 1], "target": [0, 0, 0], "fov": 40}
    for place, good, bad, words in RANGES:
        for value in good:
            done = render(drape, folder, put(report, place, value))
            assert done.returncode == 0, (place, value, done.stderr)
        for value in bad:
            done = render(drape, folder, put(report, place, value))
            told = "drape: %s/report.json: %s\n" % (folder, words)
            assert done.returncode == 2 and done.stderr == told, (
                place, value, done.stderr)


main()
