# SPDX-License-Identifier: Apache-2.0
"""The error of the closest points' vector p = sum of c x, from the operations that the
code performs, and the constants that rest on it: spec/contact/proximity.md §2.1.

The weights count as exact: they are what the points are named by. Each is 0, 1, a
parameter t in [0, 1] or 1 - t, and t must be clamped by the code; of a face, s, t and
1 - s - t, if the code has compared s, t and s + t.
"""
import math
import re

import floats
from scripts import Script, bare, gappa, place, rest_of_one
from term import Unsupported, order

PAGE = "spec/contact/proximity.md"
HAND = "spec/proofs/closest_point.gappa"
PARTS = 16  # into which a parameter's [0, 1] is split, as in the script by hand
FACE_PARTS = 4  # the same of the two of a face
ROWS = {"nearest_vf": 4, "nearest_ee": 5}  # rows, and how many candidates each has
# Constants that rest on the error: (what, the files, its text there, that of its page).
RESTS = (
    ("shortest p with a direction",
     (("reference", "ref/contact/proximity.c"), ("device", "gpu/contact/proximity.cu")),
     r"r->length2 > (0x1p-?\d+) \* r->size2\b",
     r"Where \|p\| ≤ 2\^(-?\d+) L the direction", 2),
    ("room of an axis", (("device", "gpu/contact/far.cuh"),),
     r"gap \* gap > \(1 \+ R\((0x1p-?\d+)\)\) \* \(square \* dd\)",
     r"g² > \(1 \+ 2\^(-?\d+)\) T² dd", 1),
    ("longest pair of an axis", (("device", "gpu/contact/far.cuh"),),
     r"size2 <= R\((0x1p-?\d+)\) \* square\b", r"L² ≤\s+2\^(-?\d+) T²", 1),
)
# What the page says of errors, as a part of L or, of a direction, as an angle.
COMPONENT = r"a component errs by less than 2\^(-?\d+) L, as Gappa"
LENGTH = r"d ≤ d̃ \+ 2\^(-?\d+) L"
DIRECTION = r"direction errs by less than 2\^(-?\d+)"


def read(path):
    """A file's text."""
    with open(path, encoding="utf-8") as file:
        return file.read()


def only(path, pattern):
    """What a pattern has in parentheses, if it is in a file once; else nothing."""
    found = re.findall(pattern, read(path))
    return found[0] if len(found) == 1 else None


def is_difference(term):
    """Whether a term is one coordinate of a vertex less that of the first."""
    return term.op == "+" and all(bare(k).op == "number" for k in term.args)


def products(term):
    """The (weight, difference) of a sum of products, its signs left out, each with
    the product's term."""
    term = bare(term)
    if is_difference(term):
        return [(None, term, term)]
    if term.op == "+":
        return [found for k in term.args for found in products(k)]
    if term.op == "*":
        for weight, of in (term.args, term.args[::-1]):
            if is_difference(bare(of)):
                return [(bare(weight), bare(of), term)]
    raise Unsupported("p has a term that is no weight times a difference")


def clamped(term):
    """The sign of a quotient that is clamped to [0, 1], or to [-1, 0]; 0 if a term is
    none: a choice of 0 unless n > 0 and d > 0, n / d where n < d, and 1."""
    if term.op != "choice" or term.args[1].op != "choice":
        return 0
    guard, (below, quotient, one), zero = term.args[0], term.args[1].args, term.args[2]
    if quotient.op != "/" or guard.op != "and" or below.op != "<":
        return 0
    parts = [bare(k) for k in quotient.args]
    signs = [k for test in guard.args if test.op == "<" for k in test.args]
    if ([bare(k) for k in below.args] != parts or len(signs) != 4 or
            {bare(k) for k in signs if not is_value(k, 0)} != set(parts) or
            not is_value(zero, 0) or not is_value(one, 1)):
        return 0
    return 1 if floats.value(one) > 0 else -1


def is_value(term, x):
    """Whether a term is the constant x or -x."""
    return floats.is_const(term) and abs(floats.value(term)) == x


def face_parts(weights):
    """(1 - s - t, s, t) of the weights of a face, else nothing."""
    for of in weights:
        if of is not None and of.op == "+":
            for first, second in (of.args, of.args[::-1]):
                s, t = rest_of_one(first), bare(second)
                if s is not None and second.op == "neg" and {s, t} <= set(weights):
                    return of, s, t
    return None


def has_tests(cell, s, t):
    """Whether the choices of a term look at the signs of s and t and compare s + t
    with 1."""
    seen = set()
    for term in order([cell]):
        if term.op in ("<", "<="):
            for x, limit in (term.args, term.args[::-1]):
                if is_value(limit, 0):
                    seen |= {k.id for k in (s, t) if bare(x) is k}
                if is_value(limit, 1) and x.op == "+" and set(x.args) == {s, t}:
                    seen.add("sum")
    return seen == {s.id, t.id, "sum"}


def name_face(script, cell, rest, s, t):
    """Names a face's weights: t is a part m of 1 - s."""
    if not has_tests(cell, s, t):
        raise Unsupported("s, t and s + t of a face are not compared")
    script.memo[s.id] = script.time("s")
    script.time("m")
    script.memo[t.id] = ("((1 - s) * m)",) * 2
    script.memo[rest.id] = ("((1 - s) * (1 - m))",) * 2


def name_edge(script, k, weight):
    """Names a parameter t, or the weight 1 - t, in which t may have a sign."""
    one = [x for x in weight.args if is_value(x, 1)] if weight.op == "+" else []
    signed = next((x for x in weight.args if x is not one[0])) if one else weight
    parameter, minus = bare(signed), signed.op == "neg"
    sign = clamped(parameter)
    if not sign or (one and (floats.value(one[0]) < 0) == (minus != (sign < 0))):
        raise Unsupported("a weight that is none of 0, 1, t and 1 - t")
    if parameter.id not in script.memo:
        name = f"t{k}"
        script.given.append(f"{name} in [0, 1]")
        script.memo[parameter.id] = (name if sign > 0 else f"(-{name})",) * 2
    if one:
        name = script.memo[parameter.id][0].strip("(-)")
        script.times[name] = name, name  # which of two products share is split
        script.memo[weight.id] = (f"(1 - {name})",) * 2


def script_of(cell, term):
    """The script of a component of p: its error, where L is 1."""
    script, found, inputs = Script(53), products(term), {}
    face = face_parts([w for w, _, _ in found])
    if face:
        name_face(script, cell, *face)
    for k, (weight, difference, product) in enumerate(found):
        byte = max(place(k)[1] for k in difference.args)
        if byte in inputs:
            raise Unsupported("a vertex with two weights")
        inputs[byte] = script.memo[difference.id] = script.difference(f"y{k}")
        if weight is None:
            continue
        if is_value(weight, 0):
            script.memo[product.id] = "0", "0"
        elif not face:
            name_edge(script, k, weight)
    computed, exact = script.put(term, None)
    return script.text(f"|{computed} - {exact}|", FACE_PARTS if face else PARTS)


def scripts_of(cells, values):
    """The scripts of p for every candidate of every row. cells: of a row, what one side
    leaves in memory; values: margins.values."""
    texts = []
    for row, count in ROWS.items():
        for cell in cells(row)[-5:-2]:  # of c, p, length2 and size2
            found = values([cell], conditions=False)
            if len(found) != count:
                raise Unsupported(f"{row} has {len(found)} candidates, not {count}")
            texts += [script_of(cell, term) for term in found]
    return list(dict.fromkeys(texts))


def on_page(pattern):
    """A power of two of the page, which must stand there once."""
    found = only(PAGE, pattern)
    return 2.0**int(found) if found else 0.0


def checks(jobs):
    """(whether it holds, what) of the script by hand and of the constants. jobs: what
    and the script of each that was proved."""
    hand, most = gappa(read(HAND)), 0.0
    for side in dict.fromkeys(what for what, _ in jobs):
        proved = max(gappa(text) or math.inf for what, text in jobs if what == side)
        most = max(most, proved)
        yield proved == hand, f"{HAND}, {side}: {hand}, and {proved} of the code"
    if not jobs:
        yield False, f"{HAND}: no script of the code"
    length, shortest = math.sqrt(3) * most, on_page(RESTS[0][3])
    wanted = on_page(LENGTH)
    yield 0 < length + 4 * 2.0**-53 <= 0.99 * wanted, f"d: an error < {wanted.hex()} L"
    wanted = on_page(DIRECTION)
    yield (0 < length <= 0.99 * wanted * shortest,
           f"direction of p: an error < {wanted.hex()}")
    for what, sides, pattern, page, power in RESTS:
        for side, path in sides:
            found = only(path, pattern)
            good = found and float.fromhex(found) == on_page(page)**power
            yield good, f"{what}, {side}: {found}, as on {PAGE}"
