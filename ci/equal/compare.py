# SPDX-License-Identifier: Apache-2.0
"""Whether pairs of terms are equal for all inputs.

They are if they are the same term. Else both are evaluated for inputs; where they
differ, this is a witness. Else terms within them that agree for these inputs are
proved equal by the solver, operands first, and one is put in the other's place, so
that each question is small.
"""
import dataclasses
import math
import random
import time

import floats
import logic
import solver
import words
from evaluate import values
from term import TABLE, bits_of, kids, make, order, show

SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, 2.0, 3.0, math.inf, -math.inf, math.nan, 5e-324,
           -5e-324, 2.0**-140, 2.0**-1000, 1e300, -1e300, 1 + 2.0**-52, 1 + 2.0**-23]
WITNESSES, SAMPLES, CLASS, SECONDS = 2000, 120, 4, 30


@dataclasses.dataclass
class Verdict:
    """equal: for all inputs; differs: an input shows it; open: neither. how: by which
    means, or why not; asked: questions to the solver; detail: lines to print."""

    kind: str
    how: str
    terms: int = 0
    asked: int = 0
    detail: tuple = ()


def kinds(terms):
    """How inputs are read: the number of a leaf to a sort and, of a half of a double,
    the number of the whole and which half."""
    found = {}
    for term in terms:
        inner = term.args[0] if term.op == "number" else None
        if inner is not None and inner.op == "leaf":
            found[inner.id] = term.sort, inner.id, 0
        elif inner is not None and inner.op == "joined":
            for half, part in zip((1, 0), inner.args):
                found[part.id] = term.sort, inner.id, half
    return found


def inputs(rng, mode, read):
    """A function from leaves to values. Modes: numbers of one size, special ones,
    repeated ones, small integers, numbers of many sizes."""
    chosen, shared = {}, [rng.gauss(0, 1) for _ in range(3)] + [0.0, 1.0, -0.0]

    def number(sort):
        x = (rng.gauss(0, 1), rng.choice(SPECIAL), rng.choice(shared),
             float(rng.randint(-3, 3)), rng.gauss(0, 1) * 2.0 ** rng.randint(-60, 60)
             )[mode]
        return bits_of(sort, x)

    def value(term):
        if term.id not in chosen:
            sort, whole, half = read.get(term.id, (term.sort, term.id, 0))
            if isinstance(sort, str) and sort != "b":
                key = ("number", whole)
                if key not in chosen:
                    chosen[key] = number(sort)
                bits = term.sort[1] if isinstance(term.sort, tuple) else 64
                chosen[term.id] = chosen[key] >> 32 * half & ((1 << bits) - 1)
            elif term.sort == "b":
                chosen[term.id] = bool(rng.randint(0, 1))
            else:
                chosen[term.id] = rng.choice((0, 1, 2, 3, 1, 0, 255)) & (
                    (1 << term.sort[1]) - 1)
        return chosen[term.id]

    return value


def agree(x, y):
    """Whether two values are the same, all NaN being one."""
    if isinstance(x, float):
        return (x != x and y != y) or (x == y and (
            math.copysign(1, x) == math.copysign(1, y)))
    return x == y


def can_hold(given):
    """Whether an input is found for which a condition holds: else nothing would be
    proved."""
    rng, terms = random.Random(1), order([given])
    read = kinds(terms)
    return any(values(terms, inputs(rng, k % 5, read))[given.id]
               for k in range(WITNESSES))


def witness(pairs, given, seconds):
    """The first input that shows a difference: (pair, values, inputs); else None."""
    rng, began = random.Random(1), time.process_time()
    roots = [term for pair in pairs for term in pair]
    terms = order([*roots, given])
    read = kinds(terms)
    for k in range(WITNESSES):
        if time.process_time() - began > seconds:
            return None
        value = inputs(rng, k % 5, read)
        known = values(terms, value)
        if known[given.id]:
            for pair in pairs:
                x, y = (known[term.id] for term in pair)
                if not agree(x, y):
                    return pair, (x, y), value
    return None


REBUILD = {"+": floats.add, "*": floats.mul, "/": floats.div, "sqrt": floats.root,
           "neg": floats.neg, "abs": floats.size, "min": floats.least,
           "max": floats.most, "<": floats.less, "<=": floats.at_most,
           "==": floats.same, "not": logic.negate, "and": logic.both,
           "choice": logic.choose, "times": words.mul, "bits": floats.bits,
           "and_bits": words.conjunction, "or_bits": words.disjunction,
           "xor_bits": words.difference, "shl": words.shift_left,
           "lshr": words.shift_right, "ashr": words.shift_signed, "joined": words.join}


def rebuilt(term, inner):
    """A term with other operands."""
    op, sort = term.op, term.sort
    if not inner:
        return term
    if op in REBUILD:
        return REBUILD[op](*inner)
    if op == "convert":
        return floats.convert(inner[0], sort)
    if op == "number":
        return floats.number(inner[0], sort)
    if op == "cut":
        return words.cut(inner[0], term.args[1], sort[1])
    if op == "extend":
        return words.extend(inner[0], sort[1])
    if op == "extend_signed":
        return words.extend_signed(inner[0], sort[1])
    if op in ("eq", "slt", "ult"):
        return words.compare(op, *inner)
    if op in ("of_signed", "of_unsigned"):
        return floats.of_int(inner[0], sort, op == "of_signed")
    if op == "sum":
        result = words.const(sort[1], term.args[1])
        for new, (_, factor) in zip(inner, term.args[0]):
            result = words.add(result, words.mul(new, words.const(sort[1], factor)))
        return result
    return make(op, tuple(inner), sort)


def samples(terms, given, count):
    """The values of each term for inputs for which `given` holds."""
    rng, read, found = random.Random(7), kinds(terms), {t.id: [] for t in terms}
    for k in range(20 * count):
        known = values(terms, inputs(rng, k % 5, read))
        if known[given.id]:
            for number, x in known.items():
                if isinstance(x, float):
                    x = "nan" if x != x else bits_of("f64", x)
                found[number].append(x)
            count -= 1
        if not count:
            break
    return {number: tuple(x) for number, x in found.items()}


class Sweep:
    """Merges terms of both sides that the solver proves equal."""

    def __init__(self, given, seconds):
        self.given, self.asked = given, 0
        self.until = time.process_time() + seconds

    def twin(self, term, candidates):
        """The candidate that equals a term; else None."""
        for other in candidates[:CLASS]:
            if time.process_time() > self.until:
                return None
            self.asked += 1
            if solver.are_equal(other, term, self.given):
                return other
        return None

    def run(self, pairs):
        """The pairs, in which equal terms are one."""
        sides = [{t.id for t in order([pair[k] for pair in pairs])} for k in (0, 1)]
        terms = order([*(t for pair in pairs for t in pair), self.given])
        seen = samples(terms, self.given, SAMPLES)
        new, classes = {}, {}
        for term in terms:
            now = rebuilt(term, [new[k.id] for k in kids(term)])
            side = (term.id in sides[0]) - (term.id in sides[1])
            known = classes.setdefault((term.sort, seen[term.id]), [])
            if side and kids(term) and all(now is not t for t, _ in known):
                found = self.twin(now, [t for t, s in known if s == -side
                                        and t.sort == now.sort])
                if found:
                    now = found
                else:
                    known.append((now, side))
            elif side and kids(term):
                known.append((now, side))
            new[term.id] = now
        return [(new[a.id], new[b.id]) for a, b in pairs]


def first_difference(a, b):
    """The first terms that differ, down from two terms."""
    while True:
        ours, theirs = kids(a), kids(b)
        if a.op != b.op or a.sort != b.sort or len(ours) != len(theirs):
            return a, b
        apart = [(x, y) for x, y in zip(ours, theirs) if x is not y]
        if not apart or len(apart) == len(ours) > 1:
            return a, b
        a, b = apart[0]


def told(pair, place, sides):
    """Two terms and where they arose, as lines."""
    lines = []
    for name, term in zip(sides, first_difference(*pair)):
        at = TABLE.origin.get(term.id)
        where = f" ({place(at[0])}:{at[1]})" if at else ""
        lines.append(f"{name}{where} {show(term)[:300]}")
    return tuple(lines)


def by_witness(found, place, sides):
    """The verdict that an input shows."""
    pair, (x, y), value = found
    leaves = [t for t in order(pair) if t.op == "leaf"][:24]
    shown = " ".join(f"{show(t)}={value(t):#x}" for t in leaves)
    return Verdict("differs", "an input", detail=(
        f"{sides[0]} {x!r}, {sides[1]} {y!r} for {shown}", *told(pair, place, sides)))


def decide(pairs, given, quick, place, sides=("reference", "device")):
    """The verdict on pairs of terms, one of each side. quick: without the solver.
    place: how a file's name is shown."""
    count = len(order([t for pair in pairs for t in pair]))
    left = [pair for pair in pairs if pair[0] is not pair[1]]
    if not pairs:
        return Verdict("open", "nothing was written")
    if not can_hold(given):
        return Verdict("open", "no input was found that meets the precondition")
    if not left:
        return Verdict("equal", "rewriting", count)
    found = witness(left, given, 0.5 if quick else 8)
    if found:
        return by_witness(found, place, sides)
    if quick or solver.bitwuzla is None:
        return Verdict("open", "the solver was not asked", count)
    sweep = Sweep(given, SECONDS)
    left = [pair for pair in sweep.run(left) if pair[0] is not pair[1]]
    left = [pair for pair in left if not solver.are_equal(*pair, given, 20)]
    if not left:
        return Verdict("equal", "the solver", count, sweep.asked)
    return Verdict("open", "the solver does not know", count, sweep.asked,
                   told(left[0], place, sides))
