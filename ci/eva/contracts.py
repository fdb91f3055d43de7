#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes C of the contracts of ref/: the ACSL comments `/*@ requires … */` before the
prototypes in CONTRACTS, which Frama-C reads as they are.

usage: ci/eva/contracts.py inputs FILE   inputs that a header's contracts allow, for Eva
       ci/eva/contracts.py asserts BITS  functions that assert a contract at run time
       ci/eva/contracts.py within FILE BITS  a source whose own calls are asserted, too
       ci/eva/contracts.py flags         the linker's flags that put them in between
       ci/eva/contracts.py real          its flags for calls within a file only
       ci/eva/contracts.py names         the functions that have a contract
       ci/eva/contracts.py calls         of each, its calls within its own file

inputs: any_NAME(arguments) gives each value that a contract bounds any value within
its bounds. asserts: __wrap_NAME, which the linker calls in place of NAME from other
files, ends the program where a clause does not hold, and calls NAME. The linker does
not see calls within the file that defines NAME: `within` writes this file with
__wrap_NAME in those calls.

A clause is a conjunction of `low <= value <= high` and `low <= value`, behind `\\forall integer k, …; low <= k < high && … ==>` where it is of arrays.
"""
import re
import sys

CONTRACTS = ("ref/narrow/closest.h", "ref/narrow/filter.h", "ref/narrow/split.h",
             "ref/narrow/predicates.h", "ref/narrow/tritri.h")
CONTRACT = re.compile(r"/\*@(.*?)\*/\n([a-z][^;{]*?(\w+)\(([^;]*)\));", re.S)
ALL = re.compile(r"\\forall integer ([\w, ]+); (.*?) ==> (.*)")
LIMIT = re.compile(r"(\S+) <= (\w+) < (\S+)")
RANGE = re.compile(r"(\S+) <= ([^<=!]+?)(?: <= (\S+))?")


def contracts(paths=CONTRACTS):
    """(name, prototype, parameters, clauses) of each function that has a contract."""
    found = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        rows = CONTRACT.findall(text)
        if len(rows) != text.count("/*@"):
            raise SystemExit(f"{path}: a contract that this program does not read")
        for acsl, prototype, name, params in rows:
            acsl = " ".join(acsl.replace("\n  @", "\n").split())
            clauses = [c.strip() for c in acsl.split(";")]
            # `;` also ends what \forall binds
            texts = re.findall(r"requires ((?:\\forall [^;]*; )?[^;]*);", acsl)
            if len(texts) != acsl.count("requires") or clauses[-1]:
                raise SystemExit(f"{path}: {name}: not clauses: {acsl}")
            names = [re.search(r"(\w+)(?:\[\d*\])*$", p.strip())[1]
                     for p in params.split(",")]
            found.append((name, " ".join(prototype.split()), names, texts))
    return found


def loops(clause):
    """The loops of a clause and the parts of what must hold in them."""
    every = ALL.fullmatch(clause)
    if not every:
        return [], clause.split(" && ")
    limits = [LIMIT.fullmatch(x) for x in every[2].split(" && ")]
    if not all(limits) or [m[2] for m in limits] != every[1].split(", "):
        raise SystemExit(f"not limits: {clause}")
    return [f"for (int {k} = {low}; {k} < {high}; {k}++)"
            for low, k, high in (m.groups() for m in limits)], every[3].split(" && ")


def condition(part):
    """A part as a condition in C, which a NaN does not meet."""
    low, value, high = RANGE.fullmatch(part).groups()
    return f"{low} <= {value} && {value} <= {high}" if high else f"{low} <= {value}"


def is_whole(low, high):
    """Whether a value between two bounds is an integer: neither bound is hexadecimal,
    and weights, which are doubles between -1 and 1, have a negative one."""
    return "x" not in low + (high or "") and not low.startswith("-")


def given(part):
    """A part as an assignment of any such value. Eva then looks at each value of an
    integer by itself, as the number of others may depend on it."""
    low, value, high = RANGE.fullmatch(part).groups()
    kind = "interval" if is_whole(low, high) else "double_interval"
    split = f"\n        //@ split {value};" if kind == "interval" and high else ""
    return f"{value} = Frama_C_{kind}({low}, {high or '0x7fffffff'});{split}"


def body(clauses, statement):
    """The statements of all clauses, in their loops."""
    lines = []
    for clause in clauses:
        heads, parts = loops(clause)
        lines += [f"    {head}" for head in heads] + (["    {"] if heads else [])
        lines += [f"        {statement(part)}" for part in parts]
        lines += ["    }"] if heads else []
    return "\n".join(lines)


def inputs(path):
    """Functions that set what a contract bounds; numbers through pointers."""
    print('#include "__fc_builtin.h"')
    for name, prototype, _, clauses in contracts([path]):
        params = re.search(rf"\b{name}(\(.*\))$", prototype)[1].replace("const ", "")
        numbers = re.findall(r"\bint (\w+)", params)
        params = re.sub(r"\bint (\w+)", r"int *\1", params)
        for number in numbers:
            clauses = [re.sub(rf"\b{number}\b", f"(*{number})", c) for c in clauses]
        print(f"static void any_{name}{params}\n{{\n"
              + body(clauses, given) + "\n}")


def asserts(bits):
    """Functions that assert a contract."""
    print("#include <stdio.h>\n#include <stdlib.h>")
    for path in CONTRACTS:
        print(f'#include "{path}"')
    print('static void outside(const char *name, const char *clause)\n{\n'
          '    fprintf(stderr, "outside the contract of %s: %s\\n", name, clause);\n'
          "    _Exit(70);\n}")
    for name, prototype, names, clauses in contracts():
        for kind in ("real", "wrap"):
            other = re.sub(rf"\b{name}\(", f"__{kind}_{name}_{bits}(", prototype)
            print(other + ";" if kind == "real" else other)
        checks = body(clauses, lambda part, name=name: (
            f'if (!({condition(part)}))\n            outside("{name}", "{part}");'))
        call = f"__real_{name}_{bits}({', '.join(names)});"
        result = "" if prototype.startswith("void ") else "return "
        print(f"{{\n{checks}\n    {result}{call}\n}}")


def wrapped(name, bits):
    """What is called in place of a function."""
    return f"__wrap_{name}_{bits}"


def source_of(path):
    """A header's source, whose comments are empty lines."""
    with open(path[:-1] + "c", encoding="utf-8") as file:
        return re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), file.read(),
                      flags=re.S)


def calls_in(text, name):
    """The places of a function's calls: its name where the line does not begin with a
    definition. A name without arguments would be a call that is not seen."""
    places = list(re.finditer(rf"\b{name}\b", text))
    if any(text[m.end()] != "(" for m in places):
        raise SystemExit(f"{name}: a use that is no call")
    return [m for m in places
            if text[text.rfind("\n", 0, m.start()) + 1].isspace()]


def within(path, bits):
    """A source with its own calls of functions that have a contract in other words."""
    header = path[:-1] + "h"
    text, known = source_of(header), ""
    for name, prototype, *_ in contracts([header]):
        for call in reversed(calls_in(text, name)):
            text = text[:call.start()] + wrapped(name, bits) + text[call.end():]
        known += re.sub(rf"\b{name}\(", wrapped(name, bits) + "(", prototype) + ";\n"
    print(f'#include "{header}"\n{known}#line 1 "{path}"\n{text}', end="")


def calls():
    """Prints of each function that has a contract how many calls its own file has."""
    for path in CONTRACTS:
        text = source_of(path)
        for name, *_ in contracts([path]):
            print(name, len(calls_in(text, name)), path[:-1] + "c")


def main(what, of=None, bits=None):
    """Prints what is asked."""
    if what == "inputs":
        inputs(of)
    elif what == "asserts":
        asserts(of)
    elif what == "within":
        within(of, bits)
    elif what == "calls":
        calls()
    elif what == "real":
        print(" ".join(f"-Wl,--defsym=__real_{name}_{k}={name}_{k}"
                       for name, *_ in contracts() for k in (32, 64)))
    elif what == "flags":
        print(" ".join(f"-Wl,--wrap={name}_{bits}" for name, *_ in contracts()
                       for bits in (32, 64)))
    elif what == "names":
        print("\n".join(name for name, *_ in contracts()))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 1 else sys.exit(__doc__)
