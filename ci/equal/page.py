# SPDX-License-Identifier: Apache-2.0
"""The tables of spec/proofs.md: which twins are proved, and what no proof reaches."""
import re

import census

PAGE = "spec/proofs.md"
MARK = "<!-- `make prove WRITE=1` writes what follows. -->\n"
BITS = (32, 64)


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


def how_of(verdicts, twin):
    """How both precisions of a twin are proved."""
    told = []
    for bits in BITS:
        verdict = verdicts.get((twin.name, bits))
        told.append("open: not asked" if verdict is None else verdict.how
                    if verdict.kind == "equal" else f"open: {why(verdict.how)}")
    if told[0] == told[1]:
        return told[0]
    return "; ".join(f"{bits} bits: {how}" for bits, how in zip(BITS, told))


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


def census_table(twins):
    """A row for each room of gpu/."""
    lines = ["| room | reached | " + " | ".join(census.REASONS) + " |",
             "| --- |" + " ---: |" * (1 + len(census.REASONS))]
    for room, kinds in census.count(twins).items():
        counts = [str(len(kinds[kind])) for kind in ("reached", *census.REASONS)]
        lines.append(f"| {room} | " + " | ".join(counts) + " |")
    return "\n".join(lines)


def tables(twins, how):
    """Both tables."""
    return (f"\n## 5 Twins\n\n{twins_table(twins, how)}\n\n## 6 Device functions\n\n"
            f"{census_table(twins)}\n")


def write(twins, verdicts):
    """Writes the tables. What was not asked now stays as it is recorded."""
    known = recorded()
    how = {}
    for twin in twins:
        asked = (twin.name, BITS[0]) in verdicts and (twin.name, BITS[1]) in verdicts
        how[twin.name] = how_of(verdicts, twin) if asked else "; ".join(dict.fromkeys(
            known.get((twin.name, bits), "open: not asked") for bits in BITS))
    head, _ = read()
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(head + tables(twins, how))


def check(twins, verdicts):
    """Whether the page has these twins, their inputs and the census of gpu/; with
    verdicts also whether it says how each is proved."""
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
    results.append(census_table(twins) in said)
    if not results[-1]:
        print(f"FAILED {PAGE}: its census of gpu/ is of another tree: "
              "make prove WRITE=1")
    for (name, bits), verdict in (verdicts or {}).items():
        now = "proved" if verdict.kind == "equal" else "open"
        was = known.get((name, bits), "open")
        if now == "proved" and was.startswith("open"):
            results.append(False)
            print(f"FAILED {PAGE}: {name} {bits} is proved: make prove WRITE=1")
    return results
