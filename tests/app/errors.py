# SPDX-License-Identifier: Apache-2.0
"""What `drape run --error` chooses and estimates, measured anew by runs of the
settings that it chose (spec/accuracy.md §9).

usage: errors.py DRAPE
Fails with a line that names the settings.
"""
import json
import math
import subprocess
import sys

from geometry import load

FRAMES = 6  # of a trial, at most
# Sheets in the wind, and a ball that does not count.
SCENE = {"frames": FRAMES, "precision": 64, "steps_per_frame": 2, "dt": 1 / 120,
         "cloths": [{"particles": [7, 5], "size": [0.3, 0.2],
                     "start": {"at": [0, y, 0]}, "pins": [{"edge": "u0"}]}
                    for y in (1, 2)],
         "obstacles": [{"shape": "sphere", "radius": 0.2}],
         "gravity": [0, -20, 0], "wind": {"velocity": [0, 0, 20]}}


def run(drape, scene, *options):
    """The report of a run, and the cloths' last positions."""
    with open("errors.json", "w") as file:
        json.dump(scene, file)
    done = subprocess.run([drape, "run", "errors.json", "--out", "errors",
                           "--force", "--quiet", *options],
                          capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    with open("errors/report.json") as file:
        report = json.load(file)
    frames = report["settings"]["frames"]
    return report, load("errors/frames/cloth_%04d.ply" % frames)[0]


def estimate(drape, setting):
    """Twice the distance of two runs: with the setting, and with half its step
    and a hundredth of its tolerance."""
    x = []
    for k in (1, 2):
        fine = {**SCENE, **setting, "dt": setting["dt"] / k,
                "steps_per_frame": setting["steps_per_frame"] * k,
                "tolerance": setting["tolerance"] / 100 ** (k - 1)}
        x.append(run(drape, fine)[1])
    return 2 * math.sqrt(sum(math.dist(p, q) ** 2 for p, q in zip(*x)) / len(x[0]))


def chosen(report):
    return {"dt": report["dt"], "steps_per_frame": report["steps_per_frame"],
            **{k: report["settings"][k] for k in ("tolerance", "integrator")}}


def check_estimate(drape):
    """The first setting that promises this error does not keep it here."""
    asked = 0.015
    report, _ = run(drape, {**SCENE, "frames": FRAMES + 3}, "--error", str(asked))
    told, setting = report["error"], chosen(report)
    assert math.isclose(told["estimated"], estimate(drape, setting),
                        rel_tol=1e-5), (told, setting)
    assert told["asked"] == asked >= told["estimated"], told
    assert math.isclose(told["horizon"], FRAMES / 60, rel_tol=1e-5), told
    first = {"dt": 1 / 120, "steps_per_frame": 2, "tolerance": 1e-2,
             "integrator": "baraff-witkin"}
    assert setting["dt"] < first["dt"] and estimate(drape, first) > asked


def check_steps(drape):
    """Each setting of the list has half the step of the one before it, whatever
    the step of the scene; of a single frame all are good enough."""
    calm = {**SCENE, "frames": 1, "wind": {}, "gravity": [0, 0, 0],
            "steps_per_frame": 1, "dt": 1 / 60}
    for k, asked in enumerate([.03, .015, .007, .004, .0025, .0015, 7e-4, 1e-4]):
        for own in (1, 2):
            scene = {**calm, "dt": 1 / 60 / own, "steps_per_frame": own}
            report, _ = run(drape, scene, "--error", str(asked))
            steps = max(own, 2 ** k)
            assert report["steps_per_frame"] == steps, (asked, own, report["dt"])
            assert math.isclose(report["dt"] * steps, 1 / 60), (asked, own)
            assert math.isclose(report["error"]["horizon"], 1 / 60, rel_tol=1e-5)


check_estimate(sys.argv[1])
check_steps(sys.argv[1])
