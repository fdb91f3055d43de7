#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What changes the digest that a certificate is of, and what does not.

usage: tests/tree.py; ends with `N passed, N failed`.
"""
import os
import sys

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "ci"))
import tree  # noqa: E402: it lies in ci/

BASE = '''/* A comment. */
#include "a.h"
#define TWICE(x) \\
    (2 * (x)) /* of it */
static const double HALF = 1e-3; // a number
int f(int a, int b)
{
    const char *s = "a  /* b";
    return a + +b > 'c' ? a << 2 : TWICE(b);
}
'''
# What is replaced, by what, and whether that is other code.
CHANGES = [
    ("A comment.", "Another,\n * longer one.", False),
    ("// a number", "", False),
    ("/* of it */", "", False),
    ("    return a +", "  return  a\n        +", False),
    ("int f(int a, int b)\n{", "int\nf(int a,\n  int b) {", False),
    ("1e-3", "1e+3", True),
    ("a + +b", "a++b", True),
    ("> 'c'", ">= 'c'", True),
    ("> 'c'", "> 'd'", True),
    ("<< 2", ">> 2", True),
    ("(2 * (x))", "(3 * (x))", True),
    ('"a  /* b"', '"a /* b"', True),
    ('"a.h"', '"b.h"', True),
    (" \\\n    (2", "\n    (2", True),
    ("static const", "const", True),
    ("TWICE(b)", "TWICE /* x */ (b)", False),
]

failed = 0
for old, new, other in CHANGES:
    assert BASE.count(old) == 1, old
    changed = tree.code(BASE) != tree.code(BASE.replace(old, new))
    failed += changed != other
    if changed != other:
        print(f"FAILED tree: {old!r} by {new!r}")
lines = ["MODEL := -a\n", "CUDA = nvcc -b \\\n", " -c\n", "OTHER = -d\n"]
plain = tree.flags(lines)
for k, other in ((0, True), (1, True), (2, True), (3, False)):
    planted = lines[:k] + [lines[k].replace("-", "-x")] + lines[k + 1:]
    failed += (tree.flags(planted) != plain) != other
total = len(CHANGES) + 4
print(f"{total - failed} passed, {failed} failed")
sys.exit(failed > 0)
