# SPDX-License-Identifier: Apache-2.0
"""Terms: what a program computes, as a graph of operations on its inputs.

A term has an operation, operands, a sort and a number. Two terms of the same
operation and operands are one object, so that terms are compared by `is`. Sorts are
"f32" and "f64", ("i", bits) for integers, and "b" for conditions. floats.py,
words.py and logic.py make terms; each rewrites what it makes by laws that hold for
every input.
"""
import collections
import struct
import sys

WIDTH = {"f32": 32, "f64": 64}
sys.setrecursionlimit(1000000)


class Unsupported(Exception):
    """What the engine has no meaning for. Nothing is proved then."""


class Term:
    """One operation on terms and plain values (constants, names, bit numbers)."""

    __slots__ = ("args", "id", "op", "sort")

    def __init__(self, op, args, sort, number):
        self.op, self.args, self.sort, self.id = op, args, sort, number


class Table:
    """All terms of one question. zeros: whether comparisons are written so that they
    do not see the sign of a zero (floats.unsigned); without, they are kept closer to
    the code. Either way is exact. origin: the source line in which a term arose."""

    def __init__(self):
        self.terms, self.memos, self.origin = {}, {}, {}
        self.zeros = False

    def start(self, zeros=False):
        """Forgets all terms but the two truth values."""
        self.terms.clear()
        self.memos = collections.defaultdict(dict)
        self.origin, self.zeros = {}, zeros
        for truth in (TRUE, FALSE):
            self.terms[truth.op, truth.sort] = truth


def make(op, args, sort):
    """The term of this operation."""
    key = (op, sort, *(a.id if isinstance(a, Term) else ("value", a) for a in args))
    found = TABLE.terms.get(key)
    if found is None:
        found = TABLE.terms[key] = Term(op, args, sort, len(TABLE.terms))
    return found


def leaf(name, sort):
    """An input. Names must be injective: two inputs of one name would be one."""
    return make("leaf", (name,), sort)


def integers(width):
    """The sort of integers of so many bits."""
    return ("i", width)


def is_float(sort):
    """Whether a sort is one of the two of floating-point numbers."""
    return sort in WIDTH


def width(sort):
    """The bits of a number of this sort."""
    return WIDTH[sort] if sort in WIDTH else sort[1]


def bits_of(sort, x):
    """The bits of a Python float that is rounded to a sort."""
    if sort == "f64":
        return struct.unpack("<Q", struct.pack("<d", x))[0]
    try:
        return struct.unpack("<I", struct.pack("<f", x))[0]
    except OverflowError:
        return 0x7F800000 if x > 0 else 0xFF800000


def float_of(sort, bits):
    """The Python float that has these bits in a sort."""
    code, size = ("<d", "<Q") if sort == "f64" else ("<f", "<I")
    return struct.unpack(code, struct.pack(size, bits))[0]


def signed(number, bits):
    """An integer of so many bits, read as a signed one."""
    return number - (1 << bits) if number >> (bits - 1) else number


def kids(term):
    """The operands that are terms."""
    if term.op == "sum":
        return [k for k, _ in term.args[0]]
    return [a for a in term.args if isinstance(a, Term)]


def order(roots, into=kids):
    """All terms that the roots are made of, operands first. into: the operands of a
    term that are looked at."""
    seen, out = set(), []
    stack = [(r, False) for r in roots]
    while stack:
        term, done = stack.pop()
        if done:
            out.append(term)
        elif term.id not in seen:
            seen.add(term.id)
            stack.append((term, True))
            stack += [(k, False) for k in into(term) if k.id not in seen]
    return out


def show(term, depth=4):
    """A term as text, down to so many operations."""
    if term.op == "float":
        return repr(float_of(term.sort, term.args[0]))
    if term.op == "int":
        return str(signed(term.args[0], term.sort[1]))
    if term.op == "leaf":
        name = term.args[0]
        if isinstance(name, tuple) and name[0] == "memory":
            return f"{name[1]}[{name[2]}]"
        return " ".join(map(str, name)) if isinstance(name, tuple) else name
    if depth == 0:
        return "…"
    args = kids(term) if term.op == "sum" else term.args
    inner = " ".join(show(a, depth - 1) if isinstance(a, Term) else str(a)
                     for a in args)
    return f"({term.op} {inner})"


TRUE, FALSE = Term("true", (), "b", 0), Term("false", (), "b", 1)
TABLE = Table()
TABLE.start()
