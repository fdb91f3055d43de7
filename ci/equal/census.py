#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which device functions the twins of ci/equal/twins.def reach, and what keeps the
others from a proof.

usage: ci/equal/census.py    prints each function that no proof reaches

A function is reached if a row names it, or if a function that is reached calls it: its
code is inlined there, and executed. Functions are known by their names; of a name
that several files define, all are meant.
"""
import collections
import glob
import os
import re
import sys

import table

HEAD = re.compile(r"^(?:template[^;{}]*?>\s*)?"
                  r"((?:static |inline |constexpr |__host__ )*"
                  r"(?:KERNEL |(?:static |inline |__host__ |__noinline__ )*"
                  r"__device__ )[^;{}=]*?\b(\w+)\([^;{}]*\)\s*(?:const\s*)?)\{",
                  re.M | re.S)
TOGETHER = re.compile(r"__sync|cluster_|grid_sync|__shfl|block_|__ballot|lane_|"
                      r"__shared__|_by_warp|all_sums|grid_sums|copies_|bulk_")
FIXED = re.compile(r"<=?\s*(?:\d+|[A-Z_]{2,}\w*)\b|>=?\s*0|= \d+; *\w+ > 0")
REASONS = ("threads work together", "an atomic", "a loop over data",
           "no loop over data, no row yet")


def functions(folder="gpu"):
    """Yields (file, name, heading, body) of the device functions."""
    for path in sorted(glob.glob(f"{folder}/*/*.cu*")):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        for found in HEAD.finditer(text):
            depth, at = 1, found.end()
            while depth and at < len(text):
                depth += (text[at] == "{") - (text[at] == "}")
                at += 1
            yield path, found[2], found[1], text[found.end():at]


def reason(heading, body):
    """What keeps a function from a proof."""
    if TOGETHER.search(heading + body):
        return REASONS[0]
    if "atomic" in body:
        return REASONS[1]
    loops = re.findall(r"\b(?:for|while)\s*\(([^{};]*;?[^;]*;?[^)]*)\)", body)
    if any(not FIXED.search(loop) for loop in loops):
        return REASONS[2]
    return REASONS[3]


def reached(found, rows):
    """The names that the rows reach."""
    calls = collections.defaultdict(set)
    names = {name for _, name, _, _ in found}
    for _, name, _, body in found:
        calls[name] |= set(re.findall(r"\b(\w+)\s*(?:<[^;()]*>)?\(", body)) & names
    new = {word for row in rows for word in re.findall(r"\w+", row.device)} & names
    seen = set()
    while new:
        seen |= new
        new = set().union(*(calls[name] for name in new)) - seen
    return seen


def count(rows):
    """Room to {reason or "reached": [(file, name)]}."""
    found, rooms = list(functions()), {}
    seen = reached(found, rows)
    for path, name, heading, body in found:
        kind = "reached" if name in seen else reason(heading, body)
        room = rooms.setdefault(path.split("/")[1], collections.defaultdict(list))
        room[kind].append((path, name))
    return rooms


def main():
    """Prints what no row reaches."""
    rows = [t for g in table.read("ci/equal/twins.def") for t in g.twins]
    for room, kinds in count(rows).items():
        for kind in REASONS:
            for path, name in kinds[kind]:
                print(f"{room}: {path}: {name}: {kind}")


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    sys.exit(main())
