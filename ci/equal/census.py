#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which device functions the twins of ci/equal/twins.def reach, and what keeps the
others from a proof.

usage: ci/equal/census.py    prints each function that no proof reaches, and why

A function is reached if a row that spec/proofs.md records as proved names it, or if a
function that is reached calls it: its code is inlined there, and executed. A HOLE is
not. A name means the function of the files that the caller's file includes; where
these have several of this name, all. A template calls those functions of the row's
files, too, that take one of the row's structs first. What a function calls keeps it
from a proof, too. Functions without loops over data are counted by themselves: those
that launches of fixed size reach besides do not make up for others.
ci/equal/left.def says of the others why they are left. Some cannot have a twin, by a
rule and not by hand (`no_twin`); they count, but what is reached of the others is told
as well.
"""
import collections
import functools
import glob
import os
import re
import sys

import page
import table

HEAD = re.compile(r"^(?:template[^;{}]*?>\s*)?"
                  r"((?:static |inline |constexpr |__host__ )*"
                  r"(?:KERNEL |(?:static |inline |__host__ |__noinline__ )*"
                  r"__device__ )[^;{}=]*?\b(\w+)\([^;{}]*\)\s*(?:const\s*)?)\{",
                  re.M | re.S)
TOGETHER = re.compile(r"__sync|cluster_|grid_sync|__shfl|block_|__ballot|lane_|"
                      r"__shared__|_by_warp|all_sums|grid_sums|copies_|bulk_")
FIXED = re.compile(r"<=?\s*(?:\d+|[A-Z_]{2,}\w*)\b|>=?\s*0|= \d+; *\w+ > 0")
REASONS = ("threads work together", "an atomic", "a loop over data")
NO_LOOP, LEFT = "no loop over data", "ci/equal/left.def"
NO_REASON = "no row yet"

# What tells an operation on a number from a copy of one; clang-format puts spaces around
# operators of two operands.
OPERATES = re.compile(r" (?:[-+*/%<>&|^?]|<<|>>|[-+*/%|&^<>=!]=|&&|\|\||<<=|>>=) |\+\+|--|"
                      r"[(=,] ?[-!~]\w|\b(?:if|for|while|switch)\b|return [-!~]")
COPIES = {"memcpy", "sizeof", "__ldg", "__ldcs", "__ldcg", "__stcs", "alignas", "make"}

Device = collections.namedtuple("Device", "path name heading body generic")


def functions(folder="gpu"):
    """The device functions."""
    found = []
    for path in sorted(glob.glob(f"{folder}/*/*.cu*")):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        for head in HEAD.finditer(text):
            depth, at = 1, head.end()
            while depth and at < len(text):
                depth += (text[at] == "{") - (text[at] == "}")
                at += 1
            found.append(Device(path, head[2], head[1], text[head.end():at],
                                head[0].startswith("template")))
    return found


@functools.cache
def included(path):
    """A file and the files that it includes."""
    seen, new = set(), [path]
    while new:
        path = new.pop()
        if path not in seen and os.path.exists(path):
            seen.add(path)
            with open(path, encoding="utf-8") as file:
                new += re.findall(r'#include "([^"]+)"', file.read())
    return seen


def reason(heading, body):
    """What in a function's own text keeps it from a proof; else None."""
    if TOGETHER.search(heading + body):
        return REASONS[0]
    if "atomic" in body:
        return REASONS[1]
    loops = re.findall(r"\b(?:for|while)\s*\(([^{};]*;?[^;]*;?[^)]*)\)", body)
    if any(not FIXED.search(loop) for loop in loops):
        return REASONS[2]
    return None


def own_copy(one, named):
    """Whether a function's own text only moves words: it has no operation but indices."""
    text, last = one.body, None
    while text != last:
        last, text = text, re.sub(r"\[[^\[\]]*\]", "", text)
    text = re.sub(r"\b(\w+)<[^<>;()]*>", r"\1", text)
    calls = set(re.findall(r"\b(\w+)\(", text)) - COPIES - set(named)
    return not OPERATES.search(" " + " ".join(text.split()) + " ") and not calls


def no_twin(calls, k):
    """Why function k can have no twin in ref/, by rule; else nothing."""
    one = calls.found[k]
    if not os.path.isdir("ref/" + one.path.split("/")[1]):
        return "by rule: its room has no counterpart in ref/"
    if "KERNEL" not in one.heading and re.search(r"\b(?:thread|block)Idx|\bgridDim|"
                                                 r"\bblockDim|\basm\b|_rank\(|rank_thread",
                                                 one.body):
        return "by rule: it depends on where a thread is, which the reference lacks"
    if all(own_copy(calls.found[j], calls.named) for j in calls.below([k])):
        return "by rule: it moves words and operates on none"
    return ""


class Calls:
    """Who calls whom, by numbers of functions."""

    def __init__(self, found):
        self.found, self.named = found, collections.defaultdict(list)
        for k, one in enumerate(found):
            self.named[one.name].append(k)
        self.of = [self.meant(one.path, one.body) - {k} for k, one in enumerate(found)]

    def meant(self, path, text, but=()):
        """The functions that a text in a file names as it calls or passes them."""
        words = re.findall(r"\b(\w+)\s*(?:<[^;()=]*>)?\(", text)
        words += re.findall(r"<(\w+)[,>]", text)
        files = included(path)
        return {k for word in set(words) - set(but) for k in self.named.get(word, ())
                if self.found[k].path in files}

    def below(self, new, but=()):
        """These functions and all that they reach."""
        seen, new = set(), list(new)
        while new:
            k = new.pop()
            if k not in seen and self.found[k].name not in but:
                seen.add(k)
                new += self.of[k]
        return seen


def first_of(one):
    """The struct to which a function's first parameter points, or nothing."""
    found = re.search(r"\((?:const )?struct (\w+) [*&]", one.heading)
    return found[1] if found else ""


def instances(calls, row, seen):
    """What templates among these functions call for the structs of a row: functions of
    the row's files that take one first, which the template's own file does not name."""
    given = row.device.partition("<")[2] if row.kernel else ""
    types = set(re.findall(r"[a-z]\w+", given))
    types |= {first_of(calls.found[k]) for k in seen if not calls.found[k].generic}
    new = set()
    for k in seen:
        if calls.found[k].generic:
            new |= {j for j in calls.meant(row.group.device, calls.found[k].body)
                    if first_of(calls.found[j]) in types - {""}}
    return new - seen


def reached(calls, rows, known):
    """The functions that rows reach of which `known` says that they are proved."""
    seen = set()
    for row in rows:
        if any(known.get((row.name, bits), "open").startswith("open")
               for bits in page.BITS):
            continue
        text, holes = row.device, row.group.holes
        if row.kernel:
            text = re.match(r"\w+", text)[0] + "()"
        mine = calls.below(calls.meant(row.group.device, text, holes), holes)
        new = instances(calls, row, mine)
        while new:
            mine |= calls.below(new, holes)
            new = instances(calls, row, mine)
        seen |= mine
    return seen


def left():
    """[(file or folder, names or nothing, reason)] of left.def, names first."""
    with open(LEFT, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    rows = []
    for inner in re.findall(r"LEFT\((.*?)\)\n", text, re.S):
        where, why, *names = (" ".join(part.split()) for part in inner.split(","))
        rows.append((where, names[0].split() if names else (), why))
    return sorted(rows, key=lambda row: (not row[1], -len(row[0])))


def why_left(rows, one):
    """What left.def says of a function."""
    return next((why for where, names, why in rows if one.path.startswith(where)
                 and (not names or one.name in names)), NO_REASON)


def count(twins, known):
    """[(function, kind: a reason of REASONS or NO_LOOP, whether it is reached, why it is
    left, why it can have no twin)]. The kind of a function follows from its text and
    from what it calls, whether it is reached or not. known: as page.recorded."""
    found = functions()
    calls, rows = Calls(found), left()
    seen = reached(calls, twins, known)
    own = [reason(one.heading, one.body) for one in found]
    result = []
    for k, one in enumerate(found):
        of = {own[j] for j in calls.below([k])}
        kind = next((r for r in REASONS if r in of), NO_LOOP)
        rule = no_twin(calls, k) if kind == NO_LOOP else ""
        open_ = kind == NO_LOOP and k not in seen
        result.append((one, kind, k in seen,
                       (rule or why_left(rows, one)) if open_ else "", rule))
    return result


def main():
    """Prints what no row reaches."""
    rows = [t for g in table.read("ci/equal/twins.def") for t in g.twins]
    for one, kind, done, why, _ in count(rows, page.recorded()):
        if not done:
            print(f"{one.path}: {one.name}: {kind}{': ' if why else ''}{why}")


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    sys.exit(main())
