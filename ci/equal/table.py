# SPDX-License-Identifier: Apache-2.0
"""Reads ci/equal/twins.def and writes what is compiled of it."""
import dataclasses
import os
import re

ROW = re.compile(r"\s*(FILES|HOLE|VALID|RESULTS|TWIN|LONG|KERNEL|EACH3|EACH|LAUNCH|BOUND)(?=\()")
HEAD = "/* Written by ci/equal/table.py from ci/equal/twins.def. */\n"


@dataclasses.dataclass
class Twin:
    """A row of the table. device: a statement, or of a KERNEL row its name; params:
    (type, name); given: the precondition, or nothing; coordinates: a thread has one of
    an item's three; long: only make prove asks it; group: the files it is in."""

    stage: str
    name: str
    params: list
    device: str
    ref: str
    given: str
    kernel: bool
    each: bool
    coordinates: bool
    shape: tuple
    long: bool
    group: "Group" = None


@dataclasses.dataclass
class Group:
    """A FILES row: the twins of one device file and one reference file. holes: name
    of a device function to (name of the reference's, arguments that only the device
    has). valid: functions of the reference to what they return
    where they find no fault in the input. results: functions of the reference to the
    parameter that holds what their calls return. bounds: rows of which only bounds.py
    reads the terms, and which are no twins."""

    device: str
    refs: list
    twins: list
    holes: dict
    valid: dict
    results: dict
    number: int = 0
    bounds: list = dataclasses.field(default_factory=list)

    @property
    def rows(self):
        """All of which wrappers are written."""
        return self.twins + self.bounds

    @property
    def name(self):
        """The name of what is written for it."""
        parts = re.sub(r"\.\w+$", "", self.device).split("/")
        return "_".join(parts[1:]) + ("_cu" if self.device.endswith(".cu") else "") + (
            f"_{self.number}" if self.number else "")

    @property
    def linked(self):
        """The reference's files that are compiled by themselves, whose functions the
        first one calls."""
        return [ref for ref in self.refs[1:] if ref.endswith(".c")]


def link_name(ref):
    """The name of the wrapper of a file that is compiled by itself."""
    return "link_" + "_".join(re.sub(r"\.c$", "", ref).split("/")[1:])


def arguments(text, at):
    """The arguments of the row whose bracket opens at a place, and its end."""
    parts, depth, begin = [], 0, at + 1
    while True:
        letter = text[at]
        depth += (letter in "([{") - (letter in ")]}")
        if depth == 0 or (depth == 1 and letter == ","):
            parts.append(" ".join(text[begin:at].split()))
            begin = at + 1
        at += 1
        if depth == 0:
            return parts, at


def params_of(text):
    """`(type name, …)` as [(type, name)]."""
    found = []
    for param in filter(None, text[1:-1].split(",")):
        kind, name = re.match(r"\s*(.*?)(\w+)\s*$", param).groups()
        found.append((kind.strip(), name))
    return found


def twin_of(kind, parts, group):
    """The twin of a row."""
    stage, name, *parts = parts
    shape = tuple(int(parts.pop(0)) for _ in range(2)) if kind == "LAUNCH" else ()
    params, *parts = parts
    plain = kind in ("TWIN", "LONG", "BOUND")
    if plain:
        device = parts.pop(0)
    else:
        device, _, case = name.partition(":")
        name = re.sub(r"<.*", "", device) + "_" + case if case else (
            re.sub(r"<", "_", device).rstrip(">"))
    ref, *given = parts
    return Twin(stage, name, params_of(params), device, ref, given[0] if given else "",
                not plain, kind[:4] == "EACH", kind == "EACH3", shape,
                kind == "LONG" or bool(shape), group)


def read(path):
    """The groups of the table."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    groups, at = [], 0
    while True:
        row = ROW.match(text, at)
        if not row:
            break
        parts, at = arguments(text, row.end())
        if row[1] == "FILES":
            number = sum(group.device == parts[0] for group in groups)
            groups.append(Group(parts[0], parts[1:], [], {}, {}, {}, number))
        elif row[1] == "VALID":
            groups[-1].valid[parts[0]] = parts[1]
        elif row[1] == "RESULTS":
            groups[-1].results[parts[0]] = parts[1]
        elif row[1] == "HOLE":
            groups[-1].holes[parts[0]] = parts[1], int(parts[2])
        else:
            rows = groups[-1].bounds if row[1] == "BOUND" else groups[-1].twins
            rows.append(twin_of(row[1], parts, groups[-1]))
    if text[at:].strip():
        raise SystemExit(f"{path}: not a row: {text[at:].strip()[:60]}")
    return groups


def signature(twin, reference):
    """The parameters of a wrapper. A kernel's reference has the kernel's as pointers
    to structs and as values, and the item."""
    texts = []
    for kind, name in twin.params:
        pointer = twin.kernel and kind.startswith("struct ") and "*" not in kind
        texts.append(f"{kind} {'*' if pointer else ''}{name}")
    if twin.kernel and reference:
        texts.append("int64_t k")
    return ", ".join(texts)


def wrappers(group):
    """The texts of the two files: CUDA and C."""
    cuda = HEAD + f'#include "{group.device}"\n'
    c = HEAD + "".join(f'#include "{ref}"\n' for ref in group.refs
                       if ref not in group.linked)
    c += '#include "ci/equal/given.h"\n'
    for twin in group.rows:
        if not twin.kernel:
            cuda += (f'extern "C" __global__ void twin_{twin.name}'
                     f"({signature(twin, False)})\n{{\n    {twin.device};\n}}\n")
        c += (f"void twin_{twin.name}({signature(twin, True)})\n"
              f"{{\n    {twin.ref};\n}}\n")
        if twin.given:
            c += (f"int given_{twin.name}({signature(twin, True)})\n"
                  f"{{\n    return {twin.given};\n}}\n")
    return cuda, c


def write(groups, folder):
    """Writes the wrappers where they have changed."""
    os.makedirs(folder, exist_ok=True)
    texts = {}
    for group in groups:
        texts[group.name + ".cu"], texts[group.name + ".c"] = wrappers(group)
        for ref in group.linked:
            texts[link_name(ref) + ".c"] = HEAD + f'#include "{ref}"\n'
    for name, text in texts.items():
        path, old = os.path.join(folder, name), None
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                old = file.read()
        if old != text:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
