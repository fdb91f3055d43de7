#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves the error bounds of filters from the operations that the code performs.

usage: ci/equal/bounds.py BUILD [--coq]    ends with `N passed, N failed, N skipped`

A filter compares a computed sum of products with C · (the sum of their magnitudes) + U.
Both sums are read from the terms of a twin, of what clang makes of ref/ and of what
nvcc makes of gpu/: which products are added, how many roundings each meets, and C. If
the magnitudes are not those of the products, or the comparison has no such bound, the
proof fails; so does one with another C. Of the roundings a Gappa script is written, in
BUILD/equal/bounds, and Gappa's bound must be below C by a hundredth, but not by far.
Of other filters, whose scripts are by hand, the constants must be used by both sides.
--coq: Gappa's proofs are exported to Coq, which checks them.
"""
import collections
import os
import re
import shutil
import subprocess
import sys

import floats
import prove
import question
import table
from term import TABLE, Unsupported, order

# Twin, and how many of its comparisons have the bound, of the reference and the device.
FILTERS = {"orient3": (2, 1), "orient2": (2, 1), "beside_plane": (6, 6), "opened": (1, 1)}
SIDES = ("reference", "device")
# Twin, and the constants that its operations must have as factors or terms of
# the filters whose scripts in spec/proofs/ are by hand.
USES = (
    ("errors_of", "ref/narrow/filter.c", ("ERROR_FORM", "ERROR_CUBIC", "UNDERFLOW")),
    ("parted", "ref/narrow/tritri.c", ("ERROR_PARTED", "UNDERFLOW")),
    ("spread", "ref/broad/cones.c", ("CONES_ROOM",)),
    ("meets", "ref/broad/box.h", ("BOX_LATE",)),
)
BITS = 64
MOST_MONOMIALS = 200


def expand(term, sizes, memo):
    """A computed sum as [(atoms, roundings)], one for each product in it; of `sizes`
    each part must be a magnitude. An atom is a difference of inputs or an input."""
    key = term.id, sizes
    if key not in memo:
        memo[key] = expanded(term, sizes, memo)
        if len(memo[key]) > MOST_MONOMIALS:
            raise Unsupported("more products than expected")
    return memo[key]


def is_input(term):
    """Whether a term is a number that the code reads."""
    return term.op in ("number", "leaf")


def bare(term):
    """A term without its sign."""
    return term.args[0] if term.op == "neg" else term


def expanded(term, sizes, memo):
    """The same, without a memory."""
    if term.op == "neg":
        return expand(term.args[0], sizes, memo)
    if term.op == "abs":
        return expand(term.args[0], "inside", memo)
    if term.op == "+" and all(is_input(bare(k)) for k in term.args):
        if sizes == "sums":
            raise Unsupported("a difference without a magnitude")
        return [((atom(term),), 1)]
    if is_input(term):
        return [(((term.id,),), 0)]
    if term.op == "+":
        if sizes == "inside" and not all(is_size(k) for k in term.args):
            raise Unsupported("the magnitude of a sum")
        return [(product, n + 1) for k in term.args
                for product, n in expand(k, sizes, memo)]
    if term.op == "*":
        left, right = (expand(k, sizes, memo) for k in term.args)
        return [(tuple(sorted(a + b)), n + m + 1) for a, n in left for b, m in right]
    raise Unsupported("a filter with " + term.op)


def atom(term):
    """What names a difference of inputs, whichever way round it is taken."""
    return tuple(sorted(bare(k).id for k in term.args))


def is_size(term):
    """Whether a sum has magnitudes only."""
    return term.op == "abs" or (term.op in ("+", "*") and all(map(is_size, term.args)))


def bound_of(term):
    """(C, the sum of magnitudes) of C · sum + U, whatever its sign; else None."""
    term = bare(term)
    if term.op != "+":
        return None
    for plus, product in (term.args, term.args[::-1]):
        plus, product = bare(plus), bare(product)
        if floats.is_const(plus) and product.op == "*":
            for factor, of in (product.args, product.args[::-1]):
                if floats.is_const(factor) and is_size(of):
                    return floats.value(factor), of
    return None


Filter = collections.namedtuple("Filter", "constant roundings sizes")


def filters_of(terms):
    """The filters among the comparisons of terms: the constant, and the most roundings
    of a product and of a magnitude."""
    found = []
    for term in order(terms):
        if term.op not in ("<", "<="):
            continue
        for side, other in (term.args, term.args[::-1]):
            bound = bound_of(other)
            if not bound:
                continue
            side = bare(side)
            products = expand(side.args[0] if side.op == "abs" else side, "", {})
            sizes = expand(bound[1], "sums", {})
            if sorted(p for p, _ in products) != sorted(p for p, _ in sizes):
                raise Unsupported("the bound's magnitudes are not those of the products")
            found.append(Filter(abs(bound[0]), max(n for _, n in products),
                                max(n for _, n in sizes)))
    return found


def script(one):
    """Gappa's script of a filter: n multiplies a product, s its magnitude in the sum,
    and k is of the product with C and of the sum with U."""
    counts = {"n": one.roundings, "s": one.sizes, "k": 2}
    lines = [f"{name} = " + " * ".join(f"(1 + {name}{i})" for i in range(1, count + 1))
             + ";" for name, count in counts.items()]
    small = [f"|{name}{i}| <= 1b-53" for name, count in counts.items()
             for i in range(1, count + 1)]
    lines.append("{ " + " /\\ ".join(small) + " -> |(n - 1) / (s * k)| in ? }")
    return "\n".join(lines) + "\n"


def gappa(text):
    """The bound that Gappa proves, or nothing."""
    said = subprocess.run(["gappa"], input=text, capture_output=True, text=True,
                          check=False)
    found = re.search(r"in \[.*\{([0-9.e+-]+), 2\^", said.stdout + said.stderr)
    return float(found[1]) if found else None


def is_power(x):
    """Whether a constant is a power of two."""
    return x > 0 and x.hex().split("p")[0] == "0x1.0000000000000"


class Results:
    """Counts results."""

    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def tell(self, good, text):
        """Counts and prints one."""
        self.passed += bool(good)
        self.failed += not good
        print(f"{'proved' if good else 'FAILED'} {text}")
        sys.stdout.flush()


def check(results, folder, twin, side, terms):
    """Proves the filters of one side of a twin."""
    name = f"{twin}, {side}"
    try:
        found = filters_of(terms)
    except Unsupported as why:
        results.tell(False, f"{name}: {why}")
        return
    kinds = set(found)
    wanted = FILTERS[twin][SIDES.index(side)]
    if len(found) != wanted or len(kinds) != 1:
        results.tell(False, f"{name}: {len(found)} bounds of {len(kinds)} kinds, not "
                            f"{wanted} of one")
        return
    one = found[0]
    text = script(one)
    with open(os.path.join(folder, f"{twin}.gappa"), "w", encoding="utf-8") as file:
        file.write(text)
    proved = gappa(text)
    good = (proved and is_power(one.constant) and proved <= 0.99 * one.constant
            and proved > one.constant / 64)
    results.tell(good, f"{name}: {one.roundings} roundings of a product, {one.sizes} of "
                       f"a magnitude: {proved} < {one.constant.hex()}")


def values(path, name):
    """What a constant of a file may be in the code: itself, so many units of rounding,
    or one and those."""
    with open(path, encoding="utf-8") as file:
        found = re.search(rf"^#define {name} (\S+)", file.read(), re.M)
    if not found:
        return ()
    x = float.fromhex(found[1]) if "x" in found[1] else float(found[1])
    return (x,) if x < 1 else (x * 2.0**-53, 1 + x * 2.0**-53)


def check_use(results, twin, side, terms, path, names):
    """Whether one side of a twin computes with its constants."""
    known = {abs(floats.value(k)) for term in order(terms) if term.op in ("*", "+")
             for k in term.args if floats.is_const(k)}
    for name in names:
        results.tell(any(x in known for x in values(path, name)),
                     f"{twin}, {side}: uses {name}")


def by_coq(results, path):
    """Lets Coq check what Gappa proves of a script."""
    name = "".join(c if c.isalnum() else "_" for c in os.path.basename(path)[:-6])
    out = os.path.join(os.path.dirname(path), name + ".v")
    with open(path, encoding="utf-8") as file:
        said = subprocess.run(["gappa", "-Bcoq"], stdin=file, capture_output=True,
                              text=True, check=False)
    with open(out, "w", encoding="utf-8") as file:
        file.write(said.stdout)
    done = subprocess.run(["coqc", "-q", out], capture_output=True, text=True,
                          check=False)
    results.tell(said.stdout and done.returncode == 0, f"{name} by Coq")


def main(build, *options):
    """Proves all."""
    results, folder = Results(), os.path.join(build, "equal", "bounds")
    os.makedirs(folder, exist_ok=True)
    used = {name: rest for name, *rest in USES}
    twins = [t for g in table.read(prove.TWINS) for t in g.twins
             if t.name in FILTERS or t.name in used]
    results.tell(prove.compile_all(build, twins, [BITS], 2) and
                 len(twins) == len(FILTERS) + len(used), "the filters' twins compile")
    for twin in twins:
        TABLE.start()
        pairs, _ = question.question(build, twin, BITS)
        for k, side in enumerate(SIDES):
            terms = [pair[k] for pair in pairs]
            if twin.name in used:
                check_use(results, twin.name, side, terms, *used[twin.name])
            else:
                check(results, folder, twin.name, side, terms)
    if "--coq" in options and shutil.which("coqc"):
        for name in sorted(FILTERS):
            by_coq(results, os.path.join(folder, name + ".gappa"))
    elif "--coq" in options:
        print("skipped: Coq's proofs: there is no coqc (sh ci/deps.sh proofs)")
        results.skipped += 1
    print(f"{results.passed} passed, {results.failed} failed, {results.skipped} skipped")
    return 1 if results.failed or not results.passed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
