# SPDX-License-Identifier: Apache-2.0
"""Gappa scripts of what terms compute, and what Gappa proves of them."""
import re
import subprocess

import floats
from term import Unsupported, order

PROVED = {}  # of each script its bound


def gappa(text):
    """The bound that Gappa proves, or nothing; asked once for each script."""
    if text not in PROVED:
        said = subprocess.run(["gappa"], input=text, capture_output=True, text=True,
                              check=False)
        found = re.search(r"in \[.*\{([0-9.e+-]+), 2\^", said.stdout + said.stderr)
        PROVED[text] = float(found[1]) if found else None
    return PROVED[text]


def is_power(x):
    """Whether a constant is a power of two."""
    return x > 0 and x.hex().split("p")[0] == "0x1.0000000000000"


def bare(term):
    """A term without its sign."""
    return term.args[0] if term.op == "neg" else term


def place(term):
    """The parameter that a number was read from, and the byte there."""
    names = [leaf.args[0] for leaf in order([term]) if leaf.op == "leaf"]
    if names[0][0] == "memory":
        return names[0][1], min(byte for _, _, byte in names)
    return names[0][1], 0


def rest_of_one(term):
    """t of a term 1 - t, else nothing."""
    if term.op == "+":
        for one, t in (term.args, term.args[::-1]):
            if floats.is_const(one) and floats.value(one) == 1 and t.op == "neg":
                return t.args[0]
    return None


def scaled(term):
    """(x, k) of a term x · 2^k, which is exact but for underflow, else nothing."""
    if term.op == "*":
        for k, x in (term.args, term.args[::-1]):
            if floats.is_const(k) and is_power(abs(floats.value(k))):
                return x, floats.value(k)
    if term.op == "+" and term.args[0] is term.args[1]:
        return term.args[0], 2.0
    return None


class Script:
    """A script: each rounded operation of a term is a name of its own, whose relative
    error is at most u, and has an exact counterpart in upper case. Not rounded are
    1 - t of a time t, and products with a power of two."""

    def __init__(self, bits):
        self.unit, self.exact, self.given = f"1b-{bits}", [], []
        self.times, self.memo, self.count = {}, {}, 0

    def near(self, number, exact):
        """Says that a number is an exact one, rounded once."""
        self.given.append(f"|{number} -/ {exact}| <= {self.unit}")

    def difference(self, name):
        """An input of size 1 at most: a difference of two numbers, rounded."""
        self.given.append(f"|{name}| <= 1")
        self.given.append(f"|{name.upper()} -/ {name}| <= {self.unit}")
        return name, name.upper()

    def know(self, term, number, exact):
        """Gives a term a name; it is an exact number, rounded once, or that itself."""
        self.memo[term.id] = number, exact
        if number != exact:
            self.near(number, exact)

    def time(self, name):
        """An input in [0, 1], which is exact."""
        if name not in self.times:
            self.times[name] = name, name
            self.given.append(f"{name} in [0, 1]")
        return self.times[name]

    def put(self, term, inputs):
        """(computed, exact) of a term. inputs: (parameter, byte) to the same of an
        input."""
        if term.id in self.memo:
            return self.memo[term.id]
        key = term.id, id(inputs)
        if key not in self.memo:
            self.memo[key] = self.new(term, inputs)
        return self.memo[key]

    def new(self, term, inputs):
        """The same, without a memory."""
        if term.op in ("number", "leaf"):
            return inputs(*place(term))
        if floats.is_const(term):
            return (floats.value(term).hex(),) * 2
        if term.op == "neg":
            return tuple(f"(-{x})" for x in self.put(term.args[0], inputs))
        if rest_of_one(term):
            return tuple(f"(1 - {x})" for x in self.put(rest_of_one(term), inputs))
        if scaled(term):
            of, by = scaled(term)
            return tuple(f"({by.hex()} * {x})" for x in self.put(of, inputs))
        if term.op not in ("+", "*", "/"):
            raise Unsupported("a polynomial with " + term.op)
        left, right = (self.put(k, inputs) for k in term.args)
        self.count += 1
        name, exact = f"r{self.count}", f"R{self.count}"
        self.exact.append(f"{exact} = {left[1]} {term.op} {right[1]};")
        self.near(name, f"({left[0]} {term.op} {right[0]})")
        return name, exact

    def text(self, goal, split):
        """The script, with what is asked. split: into how many parts times are."""
        lines = [*self.exact, "{ " + " /\\\n  ".join(self.given), f"  -> {goal} in ? }}"]
        if self.times and split > 1:
            lines.append("$ " + ", ".join(f"{t} in {split}" for t in self.times) + ";")
        return "\n".join(lines) + "\n"
