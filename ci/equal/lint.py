#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that PTX performs only the operations of the number model.

usage: ci/equal/lint.py FILE.ptx...    ends with `N passed, N failed`

The number model (spec/README.md §1) has addition, subtraction, multiplication,
division and root rounded to nearest, and comparisons. PTX may contract or
approximate operations without `.rn`, so each must have it, and ptxas may not
change those that do. An instruction on floating-point numbers that OPERATIONS
does not list is a fault.

nvcc makes `min` of `a < b ? a : b` where one operand is a constant. Both take
the other operand where one is NaN. At zeros they differ: `min` orders -0 below +0,
where §1.2 takes the second operand. So `min` with +0 and `max` with -0 are faults,
as is either of two numbers that are no constants, which only fmin and fmax give.

Before the files the lint judges the instructions of PLANTED, so that a rule that
finds nothing fails.
"""
import os
import re
import sys

FLOATS = {"f16", "f16x2", "bf16", "bf16x2", "tf32", "f32", "f32x2", "f64"}
# What may be done with floating-point numbers: with the modifier that must be
# there, or none.
OPERATIONS = {"add": "rn", "sub": "rn", "mul": "rn", "div": "rn", "sqrt": "rn",
              "rcp": "rn", "neg": None, "abs": None, "min": None, "max": None,
              "setp": None, "selp": None, "mov": None, "ld": None, "st": None,
              "cvt": None}
NEVER = {"ftz", "sat", "approx", "full"}
ZERO = {"min": ("0f00000000", "0d0000000000000000"),
        "max": ("0f80000000", "0d8000000000000000")}
# Instructions, and whether each is a fault.
PLANTED = (
    ("add.rn.f32 %f3, %f1, %f2", False),
    ("mul.rn.f64 %fd3, %fd1, 0d4000000000000000", False),
    ("div.rn.f32 %f3, %f1, %f2", False),
    ("cvt.rn.f32.f64 %f1, %fd1", False),
    ("max.f32 %f2, %f1, 0f00000000", False),
    ("min.f64 %fd2, %fd1, 0d3FF0000000000000", False),
    ("@%p1 mov.f32 %f2, 0f00000000", False),
    ("add.f32 %f3, %f1, %f2", True),
    ("@!%p1 sub.f64 %fd3, %fd1, %fd2", True),
    ("mul.rz.f32 %f3, %f1, %f2", True),
    ("fma.rn.f32 %f4, %f1, %f2, %f3", True),
    ("mad.rn.f64 %fd4, %fd1, %fd2, %fd3", True),
    ("add.rn.ftz.f32 %f3, %f1, %f2", True),
    ("setp.lt.ftz.f32 %p1, %f1, %f2", True),
    ("div.full.f32 %f3, %f1, %f2", True),
    ("rsqrt.approx.f32 %f2, %f1", True),
    ("sqrt.approx.f32 %f2, %f1", True),
    ("atom.global.add.f32 %f2, [%rd1], %f1", True),
    ("add.rn.f32x2 %rd3, %rd1, %rd2", False),
    ("fma.rn.f32x2 %rd4, %rd1, %rd2, %rd3", True),
    ("min.f32 %f2, %f1, 0f00000000", True),
    ("max.f64 %fd2, %fd1, 0d8000000000000000", True),
    ("min.f32 %f3, %f1, %f2", True),
    ("min.NaN.f32 %f2, %f1, 0f3F800000", True),
)
STATEMENT = re.compile(r"(?:@!?%\w+\s+)?([a-z]\w*(?:[.:][\w:]+)*)\s*(.*)", re.S)


def fault(statement, constants=None):
    """What is wrong with a statement, or None. constants: register to the constants
    that the function moves into it."""
    found = STATEMENT.match(statement)
    code, rest = found.groups() if found else ("", "")
    kind, *parts = code.split(".")
    if not FLOATS & set(parts):
        return None
    if kind not in OPERATIONS:
        return f"{code} is no operation of the number model"
    if NEVER & set(parts):
        return f"{code} is not exact to the last bit"
    need = OPERATIONS[kind]
    if need and need not in parts:
        return f"{code} lacks .{need}"
    if kind in ZERO:
        if len(parts) > 1:
            return f"{code} is no operation of the number model"
        operands = [word.strip() for word in rest.split(",")][1:]
        known = constants or {}
        values = set().union(*(known.get(word, {word}) for word in operands))
        if any(zero in values for zero in ZERO[kind]):
            return f"{code} of {', '.join(operands)}: another zero than §1.2"
        if all(value.startswith("%") for value in values):
            return f"{code} of two numbers: §1.2 has no such minimum"
    return None


def statements(text):
    """Yields ((number of the source file, line), statement)."""
    place = "", "0"
    for line in text.split("\n"):
        line = line.split("//", 1)[0].strip()
        if line.startswith(".loc"):
            place = tuple(line.split()[1:3])
        elif not line.startswith("."):
            for statement in re.split(r"[;{}](?![^\[]*\])", line):
                yield place, statement.strip()


def constants_of(function):
    """Register to its constants, of those that only constants are moved into."""
    known, other = {}, set()
    for _, statement in statements(function):
        found = STATEMENT.match(statement)
        if not found or found[1].startswith("st."):
            continue
        target, _, source = found[2].partition(",")
        if found[1].startswith("mov") and re.match(r"\s*0[fd]\w+$", source):
            known.setdefault(target, set()).add(source.strip())
        else:
            other.update(re.findall(r"%\w+", found[2] if "{" in target else target))
    return {register: known[register] for register in known if register not in other}


def judge(name):
    """The faults of a file as (place, what, statement), and how many instructions on
    floating-point numbers it has."""
    with open(name, encoding="utf-8") as file:
        text = file.read()
    files = dict(re.findall(r'^\s*\.file\s+(\d+)\s+"([^"]*)"', text, re.M))
    faults, count = [], 0
    for function in re.split(r"^}", text, flags=re.M):
        constants = constants_of(function)
        for (file, line), statement in statements(function):
            count += bool(re.search(r"\.(?:b?f16|tf32|f32|f64)", statement))
            what = fault(statement, constants)
            if what:
                path = os.path.relpath(files.get(file, name))
                faults.append((f"{path}:{line}", what, statement))
    return faults, count


def main(*names):
    """Judges the planted instructions, then the files."""
    passed = failed = operations = 0
    for statement, wrong in PLANTED:
        if bool(fault(statement)) == wrong:
            passed += 1
        else:
            failed += 1
            print(f"FAILED planted {statement}: "
                  f"{'not found' if wrong else fault(statement)}")
    for name in names:
        faults, count = judge(name)
        operations += count
        failed += bool(faults)
        passed += not faults
        if faults:
            print(f"FAILED {name}: {len(faults)} faults")
        for place, what, statement in faults[:10]:
            print(f"    {place}: {what}: {statement}")
    print(f"{operations} instructions on floating-point numbers, {len(names)} files")
    if not names or not operations:
        failed += 1
        print("FAILED nothing was there to judge")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
