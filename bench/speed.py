#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a step costs on this machine, as `drape plan` estimates it: a constant, so
much a particle and so much a contact.

usage: bench/speed.py MACHINE DATE OUT.csv REPORT.json...
The constants are fitted to the steps of the reports, once for steps in which
nothing touches, once for the others; each scene counts alike, and the sum of
|estimate - measured| / sqrt(estimate * measured) is least. `low` and `high` are the measured time by the
estimated one that a tenth of the steps is below and above. The first step of a run,
which loads kernels, is left out. Rows of other machines and backends stay in OUT.
"""
import csv
import json
import math
import os
import sys

NAMES = ["machine", "backend", "date", "threads", "bits", "free ms",
         "free ms a million particles", "ms", "ms a million particles",
         "ms a million contacts", "low", "high", "steps"]


def steps_of(report):
    """(particles, contacts, ms) of a run's steps, in millions."""
    n = sum(b["particles"][0] * b["particles"][1]
            for b in report["bodies"] if b["kind"] == "cloth")
    return [(n / 1e6, s["contacts"] / 1e6, 1e3 * sum(s["seconds"].values()))
            for s in report["steps"][1:] if s["outcome"] != "asleep"]


def solve(rows, values, weights):
    """The least squares of rows and values, none of the terms negative."""
    columns = len(rows[0])
    a = [[sum(w * r[i] * r[j] for r, w in zip(rows, weights))
          for j in range(columns)] for i in range(columns)]
    b = [sum(w * v * r[i] for r, v, w in zip(rows, values, weights))
         for i in range(columns)]
    x = [0.0] * columns
    for _ in range(2000):  # projected Gauss-Seidel
        for i in range(columns):
            rest = sum(a[i][j] * x[j] for j in range(columns) if j != i)
            x[i] = max(0.0, (b[i] - rest) / a[i][i]) if a[i][i] else 0.0
    return x


def fit(scenes, columns):
    """The constants of a kind of steps, by least squares that are weighed anew."""
    steps = [step for scene in scenes for step in scene]
    share = [1 / len(scene) for scene in scenes for _ in scene]
    if not steps:
        return [0.0] * columns
    rows = [(1, p, c)[:columns] for p, c, _ in steps]
    values = [ms for *_, ms in steps]
    weights = [s / ms ** 2 for s, ms in zip(share, values)]
    for _ in range(30):
        x = solve(rows, values, weights)
        told = [max(sum(a * b for a, b in zip(r, x)), 1e-9) for r in rows]
        scale = [math.sqrt(a * b) for a, b in zip(told, values)]
        weights = [s / (k * max(abs(a - b), 0.02 * k)) for s, k, a, b in
                   zip(share, scale, told, values)]
    return x


def percentile(values, part):
    return sorted(values)[int(part * (len(values) - 1))]


def row_of(machine, date, reports):
    runs = [steps_of(report) for report in reports]
    free = [[s for s in run if not s[1]] for run in runs]
    near = [[s for s in run if s[1]] for run in runs]
    free, near = [r for r in free if r], [r for r in near if r]
    a, b = fit(free, 2), fit(near, 3)
    ratio = [s[2] / (b[0] + b[1] * s[0] + b[2] * s[1]) for r in near for s in r]
    first = reports[0]
    threads = first["threads"] or os.cpu_count()
    numbers = [*a, *b, percentile(ratio, 0.1), percentile(ratio, 0.9)]
    return [machine.replace(",", " ")[:40], first["backend"], date,
            threads if first["backend"] == "ref" else 0, first["precision"], *(f"{v:.3g}" for v in numbers),
            sum(map(len, free + near))]


def write(path, new):
    """Puts a row in place of that of its machine and backend."""
    kept = []
    if os.path.exists(path):
        with open(path, newline="") as file:
            kept = [r for r in csv.reader(file) if r[:2] != new[:2]][1:]
    with open(path, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([NAMES, *kept, new])


def main():
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    machine, date, out = sys.argv[1:4]
    reports = []
    for path in sys.argv[4:]:
        with open(path) as file:
            reports.append(json.load(file))
    if len({(r["backend"], r["precision"], r["threads"]) for r in reports}) > 1:
        sys.exit("speed.py: the reports are of several backends")
    new = row_of(machine, date, reports)
    write(out, new)


if __name__ == "__main__":
    main()
