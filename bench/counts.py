#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What steps rich in contact take, as counts: small forms of the scenes of
h200/tables.md's table of contact, by the reference. Counts are exact, the same on
any machine, so each has an upper bound.

usage: counts.py DRAPE OUT   writes OUT/counts.csv; the exit status is 1 where a
                             count is above its bound or a step is not clean
"""
import csv
import json
import os
import subprocess
import sys
import tempfile

# scene: particles along a side, detail of the obstacles, frames; bounds of sums
# over all steps (iterations, solves, rounds, slices) and of the contacts of a
# particle in the last step, at most a tenth above what they were on 2026-11-30.
COUNTS = ["iterations", "solves", "rounds", "slices", "contacts a particle"]
SCENES = {
    "layers_2": (31, 32, 40, (2630, 413, 34, 44, 0.7)),
    "layers_8": (31, 32, 20, (2378, 389, 12, 22, 0.71)),
    "funnel_540k": (31, 32, 20, (2395, 683, 51, 88, 0.92)),
    "ball_past": (41, 32, 60, (1834, 422, 25, 66, 0.1)),
    "ball_stops": (41, 32, 40, (2490, 486, 37, 45, 0.1)),
}


def small(name, side, detail):
    """The scene with as many particles and as much detail."""
    with open("app/scenes/%s.json" % name, encoding="utf-8") as file:
        scene = json.load(file)
    for cloth in scene["cloths"]:
        cloth["particles"] = [side, side]
    for obstacle in scene["obstacles"]:
        if "detail" in obstacle:
            obstacle["detail"] = detail
    return scene


def run(drape, scene, frames, folder):
    """The steps of the report."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(scene, file)
    out = os.path.join(folder, "run")
    subprocess.run([drape, "run", path, "--backend", "ref", "--threads", "1",
                    "--frames", str(frames), "--every", "1000000", "--quiet",
                    "--force", "--out", out], check=True)
    with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
        return json.load(file)["steps"]


def count(steps, particles):
    return [sum(s["iterations"] for s in steps),
            sum(s["work"]["solves"] for s in steps),
            sum(s["rounds"] for s in steps), sum(s["slices"] for s in steps),
            round(steps[-1]["contacts"] / particles, 4)]


def main(drape, out):
    rows, failed = [], 0
    for name, (side, detail, frames, bounds) in SCENES.items():
        scene = small(name, side, detail)
        with tempfile.TemporaryDirectory() as folder:
            steps = run(drape, scene, frames, folder)
        found = count(steps, side * side * len(scene["cloths"]))
        for what, value, bound in zip(COUNTS, found, bounds):
            rows.append([name, side, len(steps), what, value, bound])
            if value > bound:
                failed += 1
                print("%s: %s: %g, more than %g" % (name, what, value, bound))
    with open(os.path.join(out, "counts.csv"), "w", encoding="utf-8",
              newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["scene", "particles a side", "steps", "count", "value",
                        "at most"])
        table.writerows(rows)
    print("%d passed, %d failed" % (len(rows) - failed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
