#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What steps take by tree: the rows of bench/steps.csv, and two trees side by side.

usage: bench/steps.py [--file CSV] OLD NEW [SCENE...]
           prints the scenes that both trees have rows of, and NEW over OLD
       bench/steps.py [--file CSV] add TREE CARD REPORT.json...
           adds a row a scene, in place of one that the tree has on this card: of
           several reports of a scene each step counts with its median

A row has ms of a step: median, 95th percentile, greatest, of so many runs. A tree is
a commit, or TREE:CARD where it ran on several cards. Empty: nobody noted it.
"""
import csv
import json
import math
import os
import platform
import statistics
import sys
import time

HEAD = ["scene", "tree", "date", "machine", "card", "steps", "median", "p95",
        "greatest", "runs"]
TIMES = HEAD[6:9]


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(path, rows):
    with open(path + ".part", "w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, HEAD, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    os.replace(path + ".part", path)


def step_times(report):
    """ms of each step, all its parts together."""
    return [1e3 * sum(step["seconds"].values()) for step in report["steps"]]


def row_of(tree, card, reports):
    """The row of reports of one scene."""
    runs = [step_times(report) for report in reports]
    times = sorted(map(statistics.median, zip(*runs)))
    at95 = times[max(0, math.ceil(0.95 * len(times)) - 1)]
    values = statistics.median(times), at95, times[-1]
    return dict(zip(HEAD, [reports[0]["scene"], tree, time.strftime("%Y-%m-%d"),
                           platform.machine(), card, len(times),
                           *(f"{value:.3g}" for value in values), len(runs)]))


def add(path, tree, card, names):
    rows, reports = read(path), {}
    for name in names:
        with open(name, encoding="utf-8") as file:
            report = json.load(file)
        reports.setdefault(report["scene"], []).append(report)
    new = [row_of(tree, card, each) for _, each in sorted(reports.items())]
    known = {(row["scene"], tree, card) for row in new}
    rows = [row for row in rows
            if (row["scene"], row["tree"], row["card"]) not in known]
    write(path, rows + new)
    return new


def of_tree(rows, name):
    """Scene to row of a tree, whose name may be cut short; the last row counts."""
    tree, _, card = name.partition(":")
    found = [row for row in rows if tree and card in row["card"] and
             (row["tree"].startswith(tree) or tree.startswith(row["tree"]))]
    cards = {row["card"] for row in found}
    if len(cards) > 1:
        sys.exit(f"{name} ran on {', '.join(sorted(cards))}: name one, as {tree}:CARD")
    if not found:
        trees = " ".join(dict.fromkeys(row["tree"] for row in rows))
        sys.exit(f"{name}: there are no rows of it; trees: {trees}")
    return {row["scene"]: row for row in found}


def compare(rows, old, new, scenes):
    """The lines of the comparison."""
    before, after = of_tree(rows, old), of_tree(rows, new)
    yield f"ms of a step: median, p95, greatest; {old} and {new}, and their quotients"
    for scene in scenes or [scene for scene in before if scene in after]:
        a, b = before.get(scene), after.get(scene)
        if not a or not b:
            sys.exit(f"{scene}: one of the trees has no row of it")
        words = [f"{scene:14}"]
        words += [f"{row[key]:>6}" for row in (a, b) for key in TIMES]
        words += [f"{float(b[key]) / float(a[key]):6.2f}" if a[key] and b[key]
                  else 6 * " " for key in TIMES]
        same = a["steps"] == b["steps"]
        yield " ".join(words) + ("" if same else
                                 f"  of {a['steps']} and {b['steps']} steps")
    cards = {row["card"] for each in (before, after) for row in each.values()}
    if len(cards) > 1:
        yield f"the cards differ: {', '.join(sorted(cards))}"


def main(*words):
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "steps.csv")
    if words[:1] == ("--file",) and len(words) > 1:
        path, words = words[1], words[2:]
    if words[:1] == ("add",) and len(words) > 3:
        for row in add(path, words[1], words[2], words[3:]):
            print(",".join(str(row[key]) for key in HEAD))
    elif len(words) > 1 and words[0] != "add":
        for line in compare(read(path), words[0], words[1], words[2:]):
            print(line)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(*sys.argv[1:])
