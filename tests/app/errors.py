# SPDX-License-Identifier: Apache-2.0
"""What `drape run --error` chooses and estimates, measured anew by runs of the
settings that it chose (spec/accuracy.md §9).

usage: errors.py DRAPE [brief]    brief: the cheap ones
Fails with a line that names the settings.
"""
import json
import math
import subprocess
import sys

from geometry import load

FRAMES = 9
# Sheets in the wind, and a ball that does not count.
SCENE = {"frames": FRAMES, "precision": 64, "steps_per_frame": 2, "dt": 1 / 120,
         "cloths": [{"particles": [7, 5], "size": [0.3, 0.2],
                     "start": {"at": [0, y, 0]}, "pins": [{"edge": "u0"}]}
                    for y in (1, 2)],
         "obstacles": [{"shape": "sphere", "radius": 0.2}],
         "gravity": [0, -20, 0], "wind": {"velocity": [0, 0, 20]}}


def run(drape, scene, *options):
    """The report of a run, the cloths' positions in each frame, and its notes."""
    with open("errors.json", "w") as file:
        json.dump(scene, file)
    done = subprocess.run([drape, "run", "errors.json", "--out", "errors",
                           "--force", *options],
                          capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    with open("errors/report.json") as file:
        report = json.load(file)
    frames = report["settings"]["frames"]
    return report, [load("errors/frames/cloth_%04d.ply" % k)[0]
                    for k in range(frames + 1)], done.stderr


def estimate(drape, setting):
    """Twice the distance in each frame of two runs: with the setting, and with
    half its step and a hundredth of its tolerance."""
    x = []
    for k in (1, 2):
        fine = {**SCENE, **setting, "dt": setting["dt"] / k,
                "steps_per_frame": setting["steps_per_frame"] * k,
                "tolerance": setting["tolerance"] / 100 ** (k - 1)}
        x.append(run(drape, fine)[1])
    return [2 * math.sqrt(sum(math.dist(p, q) ** 2 for p, q in zip(*both))
                          / len(both[0])) for both in zip(*x)]


def chosen(report):
    return {"dt": report["dt"], "steps_per_frame": report["steps_per_frame"],
            **{k: report["settings"][k] for k in ("tolerance", "integrator")}}


def check_estimate(drape):
    """The first setting that promises this error does not keep it to the end."""
    asked = 0.015
    report = run(drape, SCENE, "--error", str(asked))[0]
    told, setting = report["error"], chosen(report)
    assert math.isclose(told["estimated"], max(estimate(drape, setting)),
                        rel_tol=1e-5), (told, setting)
    assert told["asked"] == asked >= told["estimated"], told
    assert math.isclose(told["horizon"], FRAMES / 60, rel_tol=1e-5), told
    first = {"dt": 1 / 120, "steps_per_frame": 2, "tolerance": 1e-2,
             "integrator": "baraff-witkin"}
    assert setting["dt"] < first["dt"] and max(estimate(drape, first)) > asked


def check_horizon(drape):
    """A sheet falls on a ball: no setting of the list holds to the end, and for how
    long the one that is taken does is said."""
    global SCENE
    before, asked = SCENE, 3e-3
    SCENE = {**before, "frames": 10, "steps_per_frame": 1, "dt": 1 / 60,
             "obstacles": [{"shape": "sphere", "radius": 0.1, "detail": 8}],
             "cloths": [{"particles": [12, 12], "size": [0.5, 0.5],
                         "start": {"at": [0.01, 0.11, 0]}}], "wind": {}}
    report, _, notes = run(drape, SCENE, "--error", str(asked))
    told, errors = report["error"], estimate(drape, chosen(report))
    held = round(told["horizon"] * 60)
    assert 6 <= held < 10, told
    assert max(errors[:held + 1]) <= asked < errors[held + 1], (told, errors)
    assert math.isclose(told["estimated"], max(errors[:held + 1]), rel_tol=1e-5)
    assert "note: --error 0.003 holds for the first %.3g s of 0.167 s, and with half " \
        "the step for no longer" % told["horizon"] in notes, notes
    SCENE = before


def check_steps(drape):
    """Each setting of the list has half the step of the one before it, whatever
    the step of the scene; of a single frame all are good enough."""
    calm = {**SCENE, "frames": 1, "wind": {}, "gravity": [0, 0, 0],
            "steps_per_frame": 1, "dt": 1 / 60}
    for k, asked in enumerate([.03, .015, .007, .004, .0025, .0015, 7e-4, 1e-4]):
        for own in (1, 2):
            scene = {**calm, "dt": 1 / 60 / own, "steps_per_frame": own}
            report = run(drape, scene, "--error", str(asked))[0]
            steps = max(own, 2 ** k)
            assert report["steps_per_frame"] == steps, (asked, own, report["dt"])
            assert math.isclose(report["dt"] * steps, 1 / 60), (asked, own)
            assert math.isclose(report["error"]["horizon"], 1 / 60, rel_tol=1e-5)


check_estimate(sys.argv[1])
if sys.argv[2:] != ["brief"]:
    check_horizon(sys.argv[1])
check_steps(sys.argv[1])
