# SPDX-License-Identifier: Apache-2.0
"""Writes drape/reports.py from spec/drape.h: its enumerations and reports, with
the header's comments as their documentation.

usage: generate.py > drape/reports.py

python/tests/test_reports.py compares the file with what this prints, and its
fields with the structs that the extension was compiled with.
"""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

HEADER = Path(__file__).resolve().parent.parent / "spec/drape.h"

# enum of the header: its class, the base, and what the class is for.
ENUMS = {
    "drape_status": ("Status", "enum.IntEnum", "What a call of the library returns."),
    "drape_outcome": (
        "Outcome",
        "enum.IntFlag",
        "How a step ended: nothing, or some of these.",
    ),
}
# struct of the header: its class, and what the class is for.
STRUCTS = {
    "drape_work": ("Work", "The work that a step did; all is 0 in a step asleep."),
    "drape_step_report": (
        "StepReport",
        "What a step did. Counts marked (*) include slices that were taken again.",
    ),
    "drape_plan_row": (
        "PlanRow",
        "A row of a world's plan: a stage, whether it is used, and why.",
    ),
    "drape_memory": ("Memory", "Memory of a world's streams and records."),
}
TYPES = {
    "int": "int",
    "int64_t": "int",
    "size_t": "int",
    "double": "float",
    "const char *": "str",
    "drape_work": "Work",
}
# Fields whose type says more than C's.
SPECIAL = {
    ("drape_step_report", "outcome"): "Outcome",
    ("drape_plan_row", "on"): "bool",
}
TOP = '''# SPDX-License-Identifier: Apache-2.0
# Written by python/generate.py from spec/drape.h.
"""What the library reports: the enumerations and structs of drape.h."""

from __future__ import annotations

import enum
from dataclasses import dataclass
'''


def words(comment: str) -> str:
    """Returns a C comment's text in one line."""
    plain = " ".join(comment.removeprefix("/*").removesuffix("*/").split())
    return plain.replace("* ", "(*) ", 1) if plain.startswith("* ") else plain


def body(text: str, pattern: str) -> str:
    """Returns what is between the braces that follow a pattern."""
    found = re.search(pattern + r"\s*\{(.*?)\n\}", text, re.DOTALL)
    assert found, pattern
    return found[1]


def entries(text: str, end: str) -> list[tuple[str, str]]:
    """Returns (declaration, comment), of which `end` ends the declaration. A
    comment is of the declarations that stand before it on its lines."""
    found: list[tuple[str, str]] = []
    ends = rf"\s*([^/{end}]+?)\s*(?:{end}|(?=\s*/\*)|\s*$)\s*(/\*.*?\*/)?"
    for name, comment in re.findall(ends, text, re.DOTALL):
        if name:
            found.append((" ".join(name.split()), words(comment)))
    return found


def documented(name: str, about: str, lines: list[tuple[str, str]]) -> str:
    """Returns a class body's documentation: what it is, and each field."""
    out = ['    """' + about]
    if lines:
        out += ["", "    Attributes:"]
    for field, comment in lines:
        text = f"{field}: {comment}" if comment else field
        out += textwrap.wrap(
            text, 80, initial_indent=" " * 8, subsequent_indent=" " * 12
        )
    return "\n".join(out) + ('\n    """' if lines else '"""')


def enumeration(text: str, name: str) -> str:
    """Returns the class of an enumeration."""
    python, base, about = ENUMS[name]
    members, lines = [], []
    for entry, comment in entries(body(text, rf"enum {name}"), ","):
        key, value = (part.strip() for part in entry.split("="))
        short = key.removeprefix("DRAPE_")
        members.append(f"    {short} = {value}")
        lines.append((short, comment))
    head = f"\n\nclass {python}({base}):\n"
    return head + documented(name, about, lines) + "\n\n" + "\n".join(members) + "\n"


def member(name: str, field: str, kind: str) -> tuple[str, str]:
    """Returns a field's name and Python type."""
    array = re.fullmatch(r"(\w+)\[DRAPE_PART_COUNT\]", field)
    if array:
        return array[1], "dict[str, float]"
    return field, SPECIAL.get((name, field), TYPES[kind])


def structure(text: str, name: str) -> str:
    """Returns the dataclass of a struct."""
    python, about = STRUCTS[name]
    members, lines = [], []
    for entry, comment in entries(body(text, rf"typedef struct {name}"), ";"):
        found = re.match(r"(const char \*|\w+) ?(.*)", entry)
        assert found, entry
        pairs = [member(name, f.strip(), found[1]) for f in found[2].split(",")]
        members += [f"    {field}: {kind}" for field, kind in pairs]
        lines.append((", ".join(field for field, _ in pairs), comment))
    head = f"\n\n@dataclass(frozen=True)\nclass {python}:\n"
    return head + documented(name, about, lines) + "\n\n" + "\n".join(members) + "\n"


def parts(text: str) -> str:
    """Returns the names of the parts of a step's time."""
    names = re.findall(r"DRAPE_PART_(\w+)", body(text, "enum drape_part"))
    listed = "".join(f'    "{name.lower()}",\n' for name in names if name != "COUNT")
    about = "# The keys of StepReport.seconds, in the order of enum drape_part."
    return f"\n{about}\nPARTS = (\n{listed})\n"


def written() -> str:
    """Returns the module's text."""
    text = HEADER.read_text(encoding="utf-8")
    made = [enumeration(text, name) for name in ENUMS]
    made += [structure(text, name) for name in STRUCTS]
    return TOP + parts(text) + "".join(made)


if __name__ == "__main__":
    print(written(), end="")
