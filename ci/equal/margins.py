# SPDX-License-Identifier: Apache-2.0
"""The bounds of subdivision, boxes, cones, the separating plane and the grid's filter,
from the operations that the code performs.

Each bound is compared with the constant that the terms have, and this one with the
source's. So a constant that is changed or no longer used fails, and operations of
which nothing is proved do.
"""
import re

import floats
import nearest
from scripts import Script, bare, is_power, place, rest_of_one, scaled
from term import Unsupported, is_float, order

ARITHMETIC = ("+", "*", "/", "sqrt")
WIDTH = {32: 24, 64: 53}
GAP = 4  # units of which a gap errs by less where it is compared: refit.md §3c
PARTS = 4  # into which a time's [0, 1] is split
# Rows of ci/equal/twins.def that are read.
ROWS = ("cubic_of", "errors_of", "axis_forms", "restrict_form", "restrict_cubic",
        "cubic_at", "apart_on", "touching_on", "roots_on", "box_error", "between",
        "meets", "spread", "rough_at", "parted", "parted_corner", *nearest.ROWS)
FILTER = ("ref/narrow/filter.c", "gpu/narrow/filter.cuh")


def serial(term, name):
    """A term as text, the operands of + and × in a fixed order. name: of (parameter,
    byte) how an input is called."""
    if term.op in ("number", "leaf"):
        return name(*place(term))
    if floats.is_const(term):
        return floats.value(term).hex()
    inner = [serial(k, name) for k in term.args]
    if term.op in ("+", "*"):
        inner.sort()
    return f"({term.op} {' '.join(inner)})"


def values(terms, conditions=True):
    """The numbers that comparisons and choices are made of: all largest terms that are
    arithmetic. conditions: whether those are looked at on which choices depend."""
    found, seen, stack = {}, set(), list(terms)
    while stack:
        term = stack.pop()
        if term.id in seen:
            continue
        seen.add(term.id)
        if is_float(term.sort) and term.op in ARITHMETIC:
            found[term.id] = term
        else:
            kids = [k for k, _ in term.args[0]] if term.op == "sum" else term.args
            stack += [k for k in kids if hasattr(k, "sort")
                      and (conditions or k.sort != "b")]
    return list(found.values())


def scales(term):
    """All (C, X, U) of C · X + U in a term, each constant without its sign."""
    return [found for one in order([term]) for found in top_scale(one)]


def one_scale(term):
    """The one (C, X, U) of a term: for choices, all must have the same C and U."""
    found = scales(term)
    if len({(c, u) for c, _, u in found}) != 1:
        raise Unsupported("the bound is not C · X + U")
    return found[0]


def axes(term):
    """The axes whose inputs the factors of a product are made of, each by all six."""
    if term.op == "*":
        return sorted(axis for k in term.args for axis in axes(k))
    inputs = {place(t)[1] // 8 for t in order([term]) if t.op == "number"}
    if len(inputs) != 6 or len({k % 3 for k in inputs}) != 1:
        raise Unsupported("a size that is not the largest of an axis")
    return [inputs.pop() % 3]


class Reader:
    """What one side of the rows computes, in one precision, and the scripts of it.
    jobs: (what, script, constant, unit) to be proved; uses: (what, constant, file,
    name) to be compared with the source."""

    def __init__(self, rows, side, bits):
        self.rows, self.side, self.bits = rows, side, bits
        self.name = ("reference", "device")[side]
        self.jobs, self.uses = [], []

    @property
    def parts(self):
        """What is read of this side."""
        return (self.forms, self.cubic, self.limits, self.box_forms, self.reach,
                self.late, self.cones, self.plane, self.closest,
                *([self.rough] if self.side else []))

    def terms(self, row):
        """What a row leaves in memory."""
        return [pair[self.side] for pair in self.rows[row]]

    def job(self, what, script, constant):
        """A script to be proved, for a constant of the code."""
        if not is_power(constant):
            raise Unsupported(f"{constant.hex()} is no power of two")
        one_job = f"{what}, {self.name} {self.bits}", script, constant
        self.jobs += [one_job] if one_job not in self.jobs else []

    def use(self, name, constant, paths):
        """A constant of the code, which a file must define."""
        path = paths[self.side]
        self.uses.append((f"{name}, {self.name} {self.bits}", constant, path, name))

    def polynomial(self, what, coefficients, blossoms, constant):
        """The jobs of a polynomial that is restricted, from differences on."""
        for term in blossoms:
            script, inputs = Script(53), {}

            def difference(_, byte, script=script, inputs=inputs):
                if byte not in inputs:
                    inputs[byte] = script.difference(f"f{byte // 8}")
                return inputs[byte]

            known = [script.put(c, difference) for c in coefficients]

            def given(name, byte, script=script, known=known):
                return known[byte // 8] if name == "c" else script.time(name)

            computed, exact = script.put(term, given)
            self.job(what, script.text(f"|{computed} - {exact}|", PARTS), constant)

    def forms(self):
        """narrow_form: the forms of two edges, of which a vertex's and a face's are
        parts."""
        scale = [one_scale(t) for t in self.terms("errors_of")[1:]]
        for k, (_, size, _) in enumerate(scale):
            if axes(size) != sorted({0, 1, 2} - {k}):
                raise Unsupported("a form's bound is of other axes")
        if len({(c, u) for c, _, u in scale}) != 1:
            raise Unsupported("the bounds of forms differ")
        constant, _, small = scale[0]
        self.use("ERROR_FORM", constant, FILTER)
        self.use("UNDERFLOW", small, FILTER)
        every = self.terms("axis_forms")
        for j in range(4):
            self.polynomial(f"form {j}", every[3 * j:3 * j + 3],
                            self.terms("restrict_form"), constant)
        self.restricted("touching_on", "restrict_form", "q", 3)

    def cubic(self):
        """narrow_cubic, which is restricted to an interval and to a time."""
        constant, size, small = one_scale(self.terms("errors_of")[0])
        if axes(size) != [0, 1, 2]:
            raise Unsupported("V's bound is of other axes")
        self.use("ERROR_CUBIC", constant, FILTER)
        self.use("UNDERFLOW", small, FILTER)
        self.polynomial("V", self.terms("cubic_of"), self.terms("restrict_cubic"),
                        constant)
        self.restricted("roots_on", "restrict_cubic", "v", 4)
        at = serial(self.terms("cubic_at")[0], lambda n, b: "a" if n == "t" else f"c{b}")
        if at != serial(self.terms("restrict_cubic")[0], lambda n, b:
                        n if n in "ab" else f"c{b}"):
            raise Unsupported("cubic_at is no blossom")

    def limits(self):
        """The largest size that the bounds cover."""
        found = {floats.value(k) for t in order(self.terms("box_error")[1:])
                 if t.op in ("<", "<=") for k in t.args if floats.is_const(k)}
        self.use("RANGE", max(found, default=0.0), FILTER)

    def box_forms(self):
        """narrow_box: the box forms that are compared, a mix of two differences."""
        constant, _, small = one_scale(self.terms("box_error")[0])
        self.use("ERROR_BOX", constant, FILTER)
        self.use("UNDERFLOW", small, FILTER)
        kinds = {}
        for term in values(self.terms("apart_on")):
            first = min(place(t)[1] for t in order([term])
                        if t.op == "number" and place(t)[0] == "f")

            def name(n, byte, first=first):
                return "t" if n != "f" else f"c{(byte - first) // 8}"

            kinds[serial(term, name)] = term, first
        if len(kinds) != 1:
            raise Unsupported("box forms of several kinds")
        term, first = kinds.popitem()[1]
        script, inputs = Script(53), {}
        for byte in (first, first + 8):
            inputs[byte] = script.difference(f"f{byte // 8}")
        computed, exact = script.put(
            term, lambda n, b: inputs[b] if n == "f" else script.time(n))
        self.job("box form", script.text(f"|{computed} - {exact}|", PARTS), constant)

    def restricted(self, row, blossoms, name, count):
        """What a test compares must be the blossoms, and all of them."""
        def called(n, byte):
            return f"c{byte // 8 % count}" if n in (name, "c") else n
        compared = {serial(t, called) for t in values(self.terms(row))}
        if compared != {serial(t, called) for t in self.terms(blossoms)}:
            raise Unsupported(f"{row} compares other numbers than {blossoms}")

    def gaps(self):
        """The four gaps of an axis, each the difference of two sides and the reach:
        (gap, difference, reach)."""
        found = []
        for term, ends in zip(self.terms("between"), ((5, 0), (7, 2), (1, 4), (3, 6))):
            reach, sides = sorted(term.args, key=lambda k: k.op == "+")
            hi, lo = sorted(sides.args, key=lambda k: k.op == "neg")
            at = tuple(place(x)[1] // (self.bits // 8) for x in (hi, bare(lo)))
            if at != ends or lo.op != "neg" or reach.op != "*" or place(reach)[0] != "r":
                raise Unsupported("a gap of other operations")
            found.append((term, sides, reach))
        return found

    def reach(self):
        """box_reach and box_gap."""
        unit = 2.0**-WIDTH[self.bits]
        if self.side:
            self.same_reach()
        for gap, sides, reach in self.gaps():
            room = max(floats.value(k) for k in reach.args if floats.is_const(k)) - 1
            for name, given, goal in (
                    ("box_reach", {sides: ("d", "D", "|D| <= 2")}, "|{} - {}|"),
                    ("box_gap", {sides: ("d", "(-1)", "d <= 0"),
                                 reach: ("r", "r", "r in [0, 0.5]")}, "{} -/ {}")):
                script = Script(WIDTH[self.bits])
                for term, (number, exact, range_of) in given.items():
                    script.know(term, number, exact)
                    script.given.append(range_of)
                pair = script.put(gap, one)
                self.job(name, script.text(goal.format(*pair), 1),
                         room if name == "box_reach" else GAP * unit)
            self.use("BOX_REACH", room / unit, ("ref/broad/box.h",) * 2)

    def late(self):
        """box_late."""
        late = [(c, x, other) for t in order(self.terms("meets")) if t.op == "<"
                for side, other in (t.args, t.args[::-1])
                for c, x, _ in top_scale(side) if 1 < c < 1.5]
        if len(late) != 1:
            raise Unsupported("no times are compared with a margin")
        factor, *times = late[0]
        for term in values(times, conditions=False):
            if term.op != "/" or not all(map(is_gap, term.args)):
                raise Unsupported("a bound of other operations")
        self.job("box_late", late_script(self.bits), factor - 1)
        self.use("BOX_LATE", (factor - 1) * 2.0**WIDTH[self.bits],
                 ("ref/broad/box.h",) * 2)

    def same_reach(self):
        """The host makes the device's reach, in a function that PTX does not have: it
        must return what the row says."""
        with open("gpu/broad/box.cuh", encoding="utf-8") as file:
            body = re.search(r"real reach_of\(real r\)\s*{\s*return ([^;]*);", file.read())
        with open("ci/equal/twins.def", encoding="utf-8") as file:
            row = re.search(r"= between\(.*, (r \* .*)\);", file.read())
        if not (body and row and body[1] == row[1]):
            raise Unsupported("reach_of returns another reach")

    def cones(self):
        """cones_room: of each of three differences with a margin."""
        last = [t for t in order(self.terms("spread")) if t.op == "<"
                and all(k.op == "*" for k in t.args)
                and t.args[0].args[0] is t.args[0].args[1]]
        if len(last) != 1:
            raise Unsupported("am · bm is not compared with cm²")
        least, (am, bm) = last[0].args[0].args[0], last[0].args[1].args
        positive = [t.args[1] for t in order(self.terms("spread")) if t.op == "<"
                    and floats.is_const(t.args[0]) and floats.value(t.args[0]) == 0]
        if am not in positive or bm not in positive:
            raise Unsupported("am and bm are not compared with 0")
        for what, term in (("a", am), ("b", bm), ("c", least)):
            room, n, s = margin(term, tangent)
            self.job(f"cones_room of {what}", margin_script(self.bits, room, n, s), room)
            self.use("CONES_ROOM", room * 2.0**WIDTH[self.bits],
                     ("ref/broad/cones.c", "gpu/broad/cones.cuh"))

    def plane(self):
        """audit_parted: of each height with a margin."""
        for row in ("parted", "parted_corner"):
            kinds = {margin(t, plane_atom) for t in values(self.terms(row))}
            if len(kinds) != 1:
                raise Unsupported(f"heights of {len(kinds)} kinds")
            room, n, s = kinds.pop()
            self.job(row, margin_script(64, room, n, s), room)
            paths = "ref/narrow/tritri.c", "gpu/narrow/facing.cuh"
            self.use("ERROR_PARTED", room, paths)
            for term in values(self.terms(row)):
                _, _, small = one_scale(term)
                self.use("UNDERFLOW", small, paths)

    def closest(self):
        """closest_point, whose constant is its page's."""
        constant = nearest.on_page(nearest.COMPONENT)
        for text in nearest.scripts_of(self.terms, values):
            self.job("closest_point", text, constant)

    def rough(self):
        """narrow_rough, which only the device has."""
        found = [(t, c, x, u) for t in order(self.terms("rough_at")) if t.op == "<"
                 for k in t.args for c, x, u in top_scale(bare(k))]
        if len(found) != 2 or len({(c, x.id, u) for _, c, x, u in found}) != 1:
            raise Unsupported("the sum is not compared twice with one bound")
        compare, c, size, u = found[0]
        total = next(k for k in compare.args if size not in order([k]))
        products, sizes = (counted(t, rough_atom) for t in (bare(total), size))
        if products.keys() != sizes.keys():
            raise Unsupported("the bound's magnitudes are not those of the products")
        self.job("narrow_rough", rough_script(max(products.values()),
                                              max(sizes.values())), c)
        path = ("", "gpu/narrow/point.cuh")
        self.use("ERROR_ROUGH", c, path)
        self.use("UNDERFLOW_ROUGH", u, path)


def one(*_):
    """The reach r, to which the others are scaled."""
    return "1", "1"


def is_gap(term):
    """Whether a term is a gap of two boxes, whatever its sign."""
    def name(n, byte):
        return "r" if n == "reach" else f"p{byte}"
    found = serial(bare(term), name)
    return bool(re.fullmatch(r"\(\+ \(\+ (?:\(neg p\d+\) p\d+|p\d+ \(neg p\d+\))\) r\)",
                             found))


def top_scale(term):
    """The (C, X, U) of a term that is itself C · X + U, whatever their signs."""
    if term.op != "+":
        return []
    return [(abs(floats.value(c)), bare(x), abs(floats.value(small)))
            for small, product in (term.args, term.args[::-1])
            if floats.is_const(small) and bare(product).op == "*"
            for c, x in (bare(product).args, bare(product).args[::-1])
            if floats.is_const(c)]


def counted(term, atom):
    """Of a sum of products, each product's atoms to the most roundings that it meets.
    atom: of a term its own roundings where it is one, else nothing."""
    own = atom(term)
    if own is not None:
        return {(serial(term, lambda n, b: f"{n}{b}"),): own}
    if term.op in ("neg", "abs"):
        return counted(term.args[0], atom)
    if scaled(term):
        return counted(scaled(term)[0], atom)
    if term.op == "choice":
        parts, extra = term.args[1:], 0
    elif term.op == "+":
        parts, extra = term.args, 1
    elif term.op == "*":
        left, right = (counted(k, atom) for k in term.args)
        return {tuple(sorted(a + b)): n + m + 1 for a, n in left.items()
                for b, m in right.items()}
    else:
        raise Unsupported("a sum with " + term.op)
    found = {}
    for part in parts:
        for product, n in counted(part, atom).items():
            found[product] = max(found.get(product, 0), n + extra)
    return found


def tangent(term):
    """A tangent is a difference, rounded once; the vector that it is multiplied by may
    be any (spec/broad/cones.md §1), so that its own roundings do not count."""
    if term.op == "number":
        return 1
    if scaled(term):
        return None
    return 0 if any(t.op == "/" for t in order([term])) and term.op == "*" and not any(
        k.op == "number" for k in term.args) else None


def plane_atom(term):
    """The same of a height over a plane: the normal may be any vector."""
    if term.op == "+" and all(bare(k).op == "number" for k in term.args):
        return 1
    shares = [k for k in map(bare, term.args) if k.op == "*"] if term.op == "+" else []
    return 0 if any(x.op in ("/", "choice") for k in shares for x in k.args) else None


def rough_atom(term):
    """A coefficient, whose own error is in the script; a time of the grid and its
    difference from 1, which are exact."""
    if term.op == "number" or rest_of_one(term):
        return 0
    return 0 if scaled(term) and scaled(term)[0].op == "of_unsigned" else None


def margin(term, atom):
    """(room, roundings of a product, of a magnitude) of sum ∓ (size · room + …)."""
    for total, other in (term.args, term.args[::-1]):
        for product in bare(other).args if bare(other).op == "+" else ():
            if product.op != "*":
                continue
            for c, size in (product.args, product.args[::-1]):
                if floats.is_const(c) and floats.value(c) < 0.5:
                    products, sizes = counted(total, atom), counted(size, atom)
                    if products.keys() != sizes.keys():
                        raise Unsupported("the margin's magnitudes are of other products")
                    return (floats.value(c), max(products.values()),
                            max(sizes.values()))
    raise Unsupported("a difference without a margin")


def factors(counts, unit):
    """Definitions of products of roundings, and what bounds the roundings."""
    lines = [f"{name} = " + " * ".join(f"(1 + {name}{i})" for i in range(1, count + 1))
             + ";" for name, count in counts.items()]
    return lines, [f"|{name}{i}| <= {unit}" for name, count in counts.items()
                   for i in range(1, count + 1)]


def margin_script(bits, room, n, s):
    """n multiplies a product, s its magnitude in the sum; k: the margin's product and
    its sum; m: the last operation, on what is at most the magnitudes and the margin."""
    unit = f"1b-{WIDTH[bits]}"
    lines, small = factors({"n": n, "s": s, "k": 2}, unit)
    small.append(f"|m| <= {unit}")
    goal = f"|((n - 1) + m * (1 + {(2 * room).hex()})) / (s * k)|"
    return "\n".join([*lines, "{ " + " /\\ ".join(small) + f" -> {goal} in ? }}"]) + "\n"


def late_script(bits):
    """Of two quotients of gaps, which err by less than GAP units each: a, b and c, d.
    e, f: the quotients' roundings; h, i: those of the margin's product and sum."""
    unit = f"b-{WIDTH[bits]}"
    small = " /\\ ".join(f"|{k}| <= {GAP if k in 'abcd' else 1}{unit}"
                         for k in "abcdefhi")
    return f"""q = ((1 + c) * (1 + b) * (1 + f)) / ((1 + a) * (1 + d) * (1 + e));
{{ {small}
  -> |q / ((1 + h) * (1 + i)) - 1| in ? }}
"""


def rough_script(n, s):
    """c and d: the error of a coefficient in the sum and in the sum of magnitudes."""
    lines, small = factors({"n": n, "s": s, "k": 2}, "1b-53")
    small += ["|c| <= 1b-50", "|d| <= 1b-50"]
    goal = "|((1 + c) * n - 1) / ((1 + d) * s * k)|"
    return "\n".join([*lines, "{ " + " /\\ ".join(small) + f" -> {goal} in ? }}"]) + "\n"
