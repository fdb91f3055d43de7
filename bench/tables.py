#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The paper's figures 8 to 12, and a table of contact, from what bench/scenes.sh left.

usage: bench/tables.py WORK/results [OUT]
Writes OUT/figure8.csv ... figure12.csv, modes.csv, contact.csv, tables.md and
speed.csv, what `drape plan` estimates by (bench/speed.py), and draws the figures (bench/plots.py). OUT is the machine's folder, as bench/h200.
"""
import csv
import math
import os
import statistics
import sys

import plots
import speed
from results import Results, device_mb, machine_folder, memory, paper_rows

PARTS = ["integration", "solver", "broad", "proximity", "penetration"]
MODES = {
    "paper": "17 diagonals, Jacobi, cuBLAS",
    "cdf": "17 diagonals, Jacobi, exact sums",
    "jacobi": "symmetric half, Jacobi, exact sums",
    "ours": "symmetric half, multigrid, exact sums",
}
# The rows of the plan that belong to each of the paper's parts of memory. All
# other rows are its "auxiliary".
MEMORY = {
    "solver": ["implicit"],
    "collision": ["features", "proximity"],
    "obstacles": ["kinematics"],
    "cloth": ["state", "springs"],
    "fronts": ["front, obstacles", "front, self"],
}


def seconds(step):
    return sum(step["seconds"].values())


def frames(run):
    """The steps of each whole frame."""
    each, steps = run["steps_per_frame"], run["steps"]
    return [steps[k:k + each] for k in range(0, len(steps) - each + 1, each)]


def percentile(values, part):
    return sorted(values)[max(0, math.ceil(part * len(values)) - 1)]


def short(value):
    """A float with three digits or more; any other value as it is."""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def ratio(a, b):
    return float(a) / b if a not in ("", None) and b else ""


def audited(results, scene):
    """The numbers of frames audited and of pairs found; a line is a frame."""
    lines = results.text(scene + ".audit").splitlines()
    pairs = [int(line.split(" intersecting")[0].split()[-1])
             for line in lines]
    return (len(pairs), sum(pairs)) if pairs else ("", "")


def explicit_frame(results, scene):
    """Seconds for 1/60 s of explicit steps, from the first steps of the fall.
    The median is used, as the very first step loads the kernels."""
    run = results.runs[scene].get("explicit")
    if not run or not run["steps"]:
        return ""
    return statistics.median(map(seconds, run["steps"])) / (60 * run["dt"])


def endings(outcome):
    """How steps ended: the columns that all tables of runs share."""
    return {"with zones": outcome["zones"],
            "with rollback": outcome["rollback"],
            "unconverged": outcome["unconverged"],
            "not clean": outcome["trapped"] + outcome.get("passed", 0) +
            outcome["diverged"],
            "asleep": outcome["asleep"]}


def figure8(results, paper):
    rows = []
    for scene, run in results.ours():
        times = [sum(map(seconds, f)) for f in frames(run)]
        steps = [1e3 * seconds(s) for s in run["steps"]]
        if not times:
            continue
        outcome = run["summary"]["outcomes"]
        of_paper = paper.get(scene, {})
        count, pairs = audited(results, scene)
        rows.append({
            "scene": scene, "triangles of all": run["triangles"],
            "frames": len(times), "steps a frame": run["steps_per_frame"],
            "s a frame, mean": statistics.mean(times),
            "median": statistics.median(times),
            "p95": percentile(times, 0.95),
            "ms a step, median": statistics.median(steps),
            "p95 of steps": percentile(steps, 0.95),
            "explicit, s a frame": explicit_frame(results, scene),
            "paper: GTX 580": of_paper.get("GTX 580 s", ""),
            "GTX 680": of_paper.get("GTX 680 s", ""),
            "K20c": of_paper.get("K20c s", ""),
            "K20c / mean": ratio(of_paper.get("K20c s"),
                                 statistics.mean(times)),
            "steps": len(steps), **endings(outcome),
            "frames audited": count, "intersecting pairs": pairs})
    return rows


def figure9(results, paper):
    rows = {}
    for scene, kind, held in memory(results):
        of_paper = paper.get(scene, {})
        row = rows.setdefault(scene, {
            "scene": scene, "explicit MB": "", "implicit MB": "",
            "device in use, implicit MB": device_mb(results, scene),
            "paper: explicit GB": of_paper.get("explicit GB", ""),
            "implicit GB": of_paper.get("implicit GB", "")})
        row[kind + " MB"] = sum(held.values()) / 1e6
    return list(rows.values())


def figure10(results, _):
    rows = []
    for scene, kind, held in memory(results):
        row = {"scene": scene, "integration": kind}
        for part, stages in MEMORY.items():
            row[part + " MB"] = sum(held.pop(s) for s in stages) / 1e6
        row["auxiliary MB"] = sum(held.values()) / 1e6
        rows.append(row)
    return rows


def figure11(results, _):
    rows = []
    for scene, run in results.ours():
        for k, steps in enumerate(frames(run)):
            row = {"scene": scene, "frame": k + 1}
            for part in PARTS:
                row[part + " s"] = sum(s["seconds"][part] for s in steps)
            rows.append(row)
    return rows


def without_time(step):
    return {key: value for key, value in step.items() if key != "seconds"}


def speed_row(scene, ours, ref, of_paper):
    """A row of figure 12, from the steps that the reference did itself. Steps
    from before its checkpoint have the times of `ours`, and are left out."""
    both = [(a, b) for a, b in zip(ours["steps"], ref["steps"])
            if a["seconds"] != b["seconds"]]
    if not both:
        return None
    fast = statistics.mean(seconds(a) for a, _ in both)
    slow = statistics.mean(seconds(b) for _, b in both)
    same = all(without_time(a) == without_time(b) for a, b in both)
    return {"scene": scene, "from step": both[0][0]["step"],
            "steps": len(both), "threads": ref["threads"],
            "ms a step": 1e3 * fast, "reference ms a step": 1e3 * slow,
            "speed-up": slow / fast, "same counts and energies":
            "yes" if same else "NO",
            "paper: K20c": of_paper.get("K20c speed-up", ""),
            "GTX 680": of_paper.get("GTX 680 speed-up", "")}


def figure12(results, paper):
    rows = []
    for scene, ours in results.ours():
        refs = [run for mode, run in results.runs[scene].items()
                if mode.startswith("ref")]
        for ref in sorted(refs, key=lambda run: run["threads"]):
            row = speed_row(scene, ours, ref, paper.get(scene, {}))
            if row and row["threads"] != 1:
                row["paper: K20c"] = row["GTX 680"] = ""
            rows += [row] if row else []
    return rows


def modes(results, _):
    rows = []
    for scene in results.scenes:
        there = [m for m in MODES if m in results.runs[scene]]
        if len(there) < 2:
            continue
        steps = {m: results.runs[scene][m]["steps"] for m in there}
        count = min(map(len, steps.values()))
        before = None
        for mode in there if count else []:
            part = steps[mode][:count]
            mean = statistics.mean(map(seconds, part))
            rows.append({
                "scene": scene, "mode": mode, "what": MODES[mode],
                "steps": count, "ms a step": 1e3 * mean,
                "of it solver": 1e3 * statistics.mean(
                    s["seconds"]["solver"] for s in part),
                "iterations a step": statistics.mean(
                    s["iterations"] for s in part),
                "faster than the row before": ratio(before, mean)})
            before = mean
    return rows


def contact(results, _):
    rows = []
    for scene, run in results.ours(contact=True):
        steps = run["steps"]
        if not steps:
            continue
        ms = [1e3 * seconds(s) for s in steps]
        n = sum(math.prod(b["particles"]) for b in run["bodies"]
                if b["kind"] == "cloth")
        near = [s["contacts"] / n for s in steps if s["contacts"]] or [0]
        mean = {key: statistics.mean(s[key] for s in steps)
                for key in ("iterations", "rounds", "slices", "impacts")}
        outcome = run["summary"]["outcomes"]
        frames_audited, pairs = audited(results, scene)
        rows.append({
            "scene": scene, "triangles of all": run["triangles"],
            "dt, ms": 1e3 * run["dt"], "frames": len(frames(run)),
            "steps": len(steps), "ms a step, median": statistics.median(ms),
            "p95": percentile(ms, 0.95), "max": max(ms),
            "mean": statistics.mean(ms),
            "contacts a particle, median": statistics.median(near),
            "solves a step": statistics.mean(
                s["work"]["solves"] for s in steps),
            "iterations": mean["iterations"], "rounds": mean["rounds"],
            "impacts": mean["impacts"], "slices": mean["slices"],
            **endings(outcome),
            "frames audited": frames_audited, "intersecting pairs": pairs})
    return rows


def write_speed(results, out):
    """Writes what a step costs, which `drape plan` estimates by."""
    runs = [run for of in (False, True) for _, run in results.ours(of)]
    machine = results.machine
    if runs:
        speed.write(os.path.join(out, "speed.csv"), speed.row_of(
            machine.get("gpu") or machine["cpu"], machine["date"], runs))


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(rows[0])
        out.writerows([short(v) for v in row.values()] for row in rows)


def markdown(rows):
    lines = ["| " + " | ".join(rows[0]) + " |", "| --- " * len(rows[0]) + "|"]
    lines += ["| " + " | ".join(short(v) for v in row.values()) + " |"
              for row in rows]
    return "\n".join(lines)


def means(rows):
    """Figure 11's frames, one row a scene, with the paper's three parts."""
    short_rows = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = [row for row in rows if row["scene"] == scene]
        row = {"scene": scene}
        for part in PARTS:
            row[part + ", ms a frame"] = 1e3 * statistics.mean(
                r[part + " s"] for r in mine)
        whole = sum(v for v in row.values() if isinstance(v, float))
        row["time integration"] = "%.0f %%" % (100 / whole * (
            row["integration, ms a frame"] + row["solver, ms a frame"]))
        short_rows.append(row)
    return short_rows


FIGURES = [
    ("figure8", figure8, "Figure 8: seconds a frame",
     "A frame is 1/60 s, in as many steps as the scene says. The paper's are "
     "means of 2,000 frames. A step with zones or rollback ends clean. "
     "`drape audit` counted the pairs, exactly, in the frames kept. Explicit: "
     "RK4, 16 times the median of its first three steps of 1/960 s, in which "
     "nothing touches."),
    ("figure9", figure9, "Figure 9: memory",
     "Sums of `drape plan`'s rows at the end of the run. Explicit: RK4's "
     "world after its first steps, and what collisions filled in the implicit "
     "run. In use: what nvidia-smi shows, with CUDA's own."),
    ("figure10", figure10, "Figure 10: memory by part",
     "The paper draws these as shares, without numbers; up to half is its "
     "solver's."),
    ("figure11", figure11, "Figure 11: time by stage",
     "Means over all frames; the csv has every frame. `solver` is all linear "
     "solves, those with contacts too; `broad` is trees and fronts for both "
     "proximity and penetration."),
    ("figure12", figure12, "Figure 12: speed-up over the reference",
     "The same steps, from a checkpoint of the draped state, by ref/ on this "
     "machine's processor. The paper: one thread; 10 to 14 times over 16 "
     "cores."),
    ("modes", modes, "What each choice in the solver is worth",
     "The first steps of each scene. Mode paper is the paper's solver within "
     "our pipeline: contacts are found the same way in all rows."),
    ("contact", contact, "Contact: layers, a funnel, fast bodies",
     "Scenes that the paper does not have. Iterations, rounds, impacts and "
     "slices are means of a step, contacts of a particle the median of steps "
     "in which there are any."),
]


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    here = os.path.dirname(os.path.abspath(__file__))
    results = Results(sys.argv[1])
    out = os.path.join(here, machine_folder(results.machine))
    out = sys.argv[2] if len(sys.argv) == 3 else out
    os.makedirs(out, exist_ok=True)
    paper = paper_rows(here)
    facts = "; ".join(f"{k} {v}" for k, v in results.machine.items())
    text = ["# The paper's figures, on this machine\n",
            f"Made by `make tables`. {facts}.\n"]
    for name, make, title, words in FIGURES:
        rows = make(results, paper)
        if not rows:
            text.append(f"## {title}\n\nNothing was run for it.\n")
            continue
        write_csv(os.path.join(out, name + ".csv"), rows)
        shown = means(rows) if name == "figure11" else rows
        text.append(f"## {title}\n\n{words}\n\n{markdown(shown)}\n")
        if plots.draw(out, name):
            text.append(f"![{title}]({name}.svg)\n")
    write_speed(results, out)
    with open(os.path.join(out, "tables.md"), "w") as file:
        file.write("\n".join(text))
    print(os.path.join(out, "tables.md"))


if __name__ == "__main__":
    main()
