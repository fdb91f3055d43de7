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
Of other shapes are the bounds of margins.py and nearest.py.
--coq: Gappa's proofs are exported to Coq, which checks them.
"""
import collections
import concurrent.futures
import os
import re
import shutil
import subprocess
import sys

import floats
import margins
import nearest
import prove
import question
import table
from scripts import bare, gappa, is_power
from term import TABLE, Unsupported, order

# Twin, and how many of its comparisons have the bound, of the reference and the device.
FILTERS = {"orient3": (2, 1), "orient2": (2, 1), "beside_plane": (6, 6), "opened": (1, 1)}
SIDES = ("reference", "device")
BITS = 64  # of filters, which are the same in both precisions
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


def defined(path, name):
    """A constant as a file defines it."""
    with open(path, encoding="utf-8") as file:
        found = re.search(rf"^#define {name} (\S+)", file.read(), re.M)
    return found and (float.fromhex(found[1]) if "x" in found[1] else float(found[1]))


def read(results, reader):
    """What a reader finds of its rows; what it does not understand fails."""
    for part in reader.parts:
        try:
            part()
        except Unsupported as why:
            results.tell(False, f"{part.__name__}, {reader.name} {reader.bits}: {why}")


def margins_of(results, build, folder):
    """Proves what margins.py has, in both precisions; returns the scripts."""
    rows = [t for g in table.read(prove.TWINS) for t in g.rows if t.name in margins.ROWS]
    results.tell(prove.compile_all(build, rows, prove.BITS, 2)
                 and len(rows) == len(margins.ROWS), "the rows of bounds compile")
    jobs, paths, uses = [], {}, {}
    for bits in prove.BITS:
        TABLE.start()
        found = {t.name: question.question(build, t, bits)[0] for t in rows}
        for side in (0, 1):
            reader = margins.Reader(found, side, bits)
            read(results, reader)
            jobs += reader.jobs
            uses |= dict.fromkeys(reader.uses)
    for what, constant, path, name in uses:
        results.tell(constant == defined(path, name), f"{what} is {constant.hex()}")
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        list(pool.map(gappa, dict.fromkeys(text for _, text, _ in jobs)))
    for good, what in nearest.checks([(what, text) for what, text, _ in jobs
                                      if what.startswith("closest_point,")]):
        results.tell(good, what)
    for what, text, constant in jobs:
        proved = gappa(text)
        good = proved and constant / 64 < proved <= 0.99 * constant
        results.tell(good, f"{what}: {proved} < {constant.hex()}")
        path = os.path.join(folder, f"margin_{len(paths)}.gappa")
        if text not in paths:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            paths[text] = path
    return list(paths.values())


def by_coq(path):
    """Lets Coq check what Gappa proves of a script; returns its name and whether it
    does."""
    name = "".join(c if c.isalnum() else "_" for c in os.path.basename(path)[:-6])
    out = os.path.join(os.path.dirname(path), name + ".v")
    with open(path, encoding="utf-8") as file:
        said = subprocess.run(["gappa", "-Bcoq"], stdin=file, capture_output=True,
                              text=True, check=False)
    with open(out, "w", encoding="utf-8") as file:
        file.write(said.stdout)
    done = subprocess.run(["coqc", "-q", out], capture_output=True, text=True,
                          check=False)
    return name, said.stdout and done.returncode == 0


def main(build, *options):
    """Proves all."""
    results, folder = Results(), os.path.join(build, "equal", "bounds")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    twins = [t for g in table.read(prove.TWINS) for t in g.twins if t.name in FILTERS]
    results.tell(prove.compile_all(build, twins, [BITS], 2) and
                 len(twins) == len(FILTERS), "the filters' twins compile")
    for twin in twins:
        TABLE.start()
        pairs, _ = question.question(build, twin, BITS)
        for k, side in enumerate(SIDES):
            check(results, folder, twin.name, side, [pair[k] for pair in pairs])
    scripts = margins_of(results, build, folder)
    scripts += [os.path.join(folder, name + ".gappa") for name in sorted(FILTERS)]
    if "--coq" in options and shutil.which("coqc"):
        with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
            for name, good in pool.map(by_coq, filter(os.path.exists, scripts)):
                results.tell(good, f"{name} by Coq")
    elif "--coq" in options:
        print("skipped: Coq's proofs: there is no coqc (sh ci/deps.sh proofs)")
        results.skipped += 1
    print(f"{results.passed} passed, {results.failed} failed, {results.skipped} skipped")
    return 1 if results.failed or not results.passed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
