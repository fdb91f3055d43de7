# SPDX-License-Identifier: Apache-2.0
"""The tables of spec/proofs.md: which twins are proved, and what no proof reaches."""
import os
import re
import sys
import textwrap

import census

PAGE = "spec/proofs.md"
MARK = "<!-- `make prove WRITE=1` writes what follows. -->\n"
BITS = (32, 64)
REACH = re.compile(r"Proofs reach (\d+) of")


def read():
    """The page up to the tables, and the tables."""
    with open(PAGE, encoding="utf-8") as file:
        head, mark, tables = file.read().partition(MARK)
    return head + mark, tables


def recorded():
    """(twin, bits) to what the page records: how it is proved, or `open: …`."""
    found = {}
    for name, how in re.findall(r"^\| \S+ \| `(\w+)`[^|]*\|[^|]*\| (.*?) \|$",
                                read()[1], re.M):
        for bits in BITS:
            part = re.search(rf"{bits} bits: ([^;]*)", how)
            found[name, bits] = part[1] if part else how
    return found


def why(how):
    """Why a twin is open, whether the solver gave up or the clock rang."""
    late = ("the solver does not know", "it takes too long")
    return "the solver has no answer" if how in late else how


def told(verdict):
    """How a twin is proved in one precision, or that it is open."""
    return verdict.how if verdict.kind == "equal" else f"open: {why(verdict.how)}"


def both(parts):
    """What is to be said of both precisions."""
    if parts[0] == parts[1]:
        return parts[0]
    return "; ".join(f"{bits} bits: {how}" for bits, how in zip(BITS, parts))


def given_of(twin):
    """For which inputs a twin is proved."""
    text = twin.given.replace("&&", "and").replace("||", "or")
    return f"`{text}`" if text else "all"


def twins_table(twins, how):
    """A row for each twin."""
    lines = ["| stage | device function or kernel | inputs | proved by |",
             "| --- | --- | --- | --- |"]
    for twin in twins:
        what = ", whole" if twin.kernel else ""
        lines.append(f"| {twin.stage} | `{twin.name}`{what} | {given_of(twin)} | "
                     f"{how[twin.name]} |")
    return "\n".join(lines)


def census_table(twins, known):
    """A row for each room of gpu/, what is reached, and why the others are left."""
    kinds = ("reached", "left", *census.REASONS)
    rooms, all_of, why = {}, dict.fromkeys(kinds, 0), {}
    ruled, besides = dict.fromkeys(kinds, 0), 0
    for one, kind, done, left, rule in census.count(twins, known):
        besides += done and kind != census.NO_LOOP
        if kind == census.NO_LOOP:
            kind = "reached" if done else "left"
        ruled[kind] += bool(rule)
        room = rooms.setdefault(one.path.split("/")[1], dict.fromkeys(kinds, 0))
        room[kind] += 1
        all_of[kind] += 1
        if left:
            files = why.setdefault(left, {})
            files.setdefault(one.path, {})[one.name] = None
    lines = ["| room | no loop over data: reached | left | "
             + " | ".join(census.REASONS) + " |", "| --- |" + " ---: |" * len(kinds)]
    for room, counts in [*rooms.items(), ("all", all_of)]:
        lines.append(f"| {room} | " + " | ".join(map(str, counts.values())) + " |")
    reached, rest = all_of["reached"], all_of["left"]
    share = 100 * reached // max(1, reached + rest)
    lines.append("\n" + textwrap.fill(
        f"Proofs reach {reached} of {reached + rest} functions without loops over data, "
        f"{share} %, and {besides} others, in launches of fixed size. "
        f"{told_ruled(ruled, reached, rest)} Those that are left:", 88))
    lines += ["", "| why | functions |", "| --- | --- |"]
    for left, files in sorted(why.items()):
        where = "; ".join(f"{path}: {', '.join(f'`{name}`' for name in names)}"
                          for path, names in sorted(files.items()))
        lines.append(f"| {left} | {where} |")
    return "\n".join(lines)


def told_ruled(ruled, reached, rest):
    """The same of the functions that can have a twin."""
    mine, left = ruled["reached"], ruled["left"]
    now, of = reached - mine, reached + rest - mine - left
    return (f"{mine + left} of these without loops can have no twin by rule (no_twin in "
            f"ci/equal/census.py), of which proofs reach {mine} with others; of the "
            f"functions that can, proofs reach {now} of {of}, {100 * now // max(1, of)} %.")


def untouched(twins):
    """The stages that have no row."""
    with open("spec/stages.def", encoding="utf-8") as file:
        stages = re.findall(r"^STAGE\(\w+, \w+, (\w+),", file.read(), re.M)
    names = {twin.stage for twin in twins}
    rest = ", ".join(stage for stage in stages if stage not in names)
    return textwrap.fill(f"Stages without a row: {rest}.", 88)


def models_table():
    """The kernels that have a model."""
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                    "../models"))
    import models  # pylint: disable=import-outside-toplevel # models import the census
    return models.table()


def tables(twins, how, known):
    """All tables."""
    return (f"\n## 5 Twins\n\n{twins_table(twins, how)}\n\n{untouched(twins)}\n\n"
            f"## 6 Device functions\n\n{census_table(twins, known)}\n\n"
            f"## 7 Kernels under every schedule\n\n{models_table()}\n")


def write(twins, verdicts):
    """Writes the tables. What was not asked now stays as it is recorded."""
    how = {key: told(verdict) for key, verdict in verdicts.items()}
    how = {**recorded(), **how}
    text = {twin.name: both([how.get((twin.name, bits), "open: not asked")
                             for bits in BITS]) for twin in twins}
    text = read()[0] + tables(twins, text, how)
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(text)


def check(twins, verdicts):
    """Whether the page has these twins and their inputs, and proofs reach as many
    functions; a new function that they do not reach is no fault. With verdicts also
    whether the page says how each is proved."""
    known, said, results = recorded(), read()[1], []
    for twin in twins:
        line = f"| {twin.stage} | `{twin.name}`"
        results.append(line in said and f" | {given_of(twin)} | " in said)
        if not results[-1]:
            print(f"FAILED {PAGE}: it lacks {twin.name}, {given_of(twin)}: "
                  "make prove WRITE=1")
    names = {twin.name for twin in twins}
    for name in sorted({name for name, _ in known} - names):
        results.append(False)
        print(f"FAILED {PAGE}: {name} is no row of ci/equal/twins.def")
    census_now = census_table(twins, known)
    was, now = (int((REACH.search(text) or [0, 0])[1]) for text in (said, census_now))
    results.append(now >= was)
    if not results[-1]:
        print(f"FAILED {PAGE}: proofs reach {now} functions, not {was}: make prove WRITE=1")
    elif any(part not in said for part in (census_now, untouched(twins), models_table())):
        print(f"changed: {PAGE} lists functions, stages and models of another tree: "
              "make prove WRITE=1")
    for (name, bits), verdict in (verdicts or {}).items():
        now = "proved" if verdict.kind == "equal" else "open"
        was = known.get((name, bits), "open")
        if now == "proved" and was.startswith("open"):
            results.append(False)
            print(f"FAILED {PAGE}: {name} {bits} is proved: make prove WRITE=1")
    return results
