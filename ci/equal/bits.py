#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Derives how many bits and words the integers of the exact predicates may have, and
checks the rooms that the code gives them: spec/narrow/narrow.md §6.5.

usage: ci/equal/bits.py    ends with `N passed, N failed`

The steps of gpu/narrow/system.cuh, roots.cuh and predicates.cuh are taken with bounds
for numbers, and an arena that hands out words as big.cuh does: a sum takes one word
more than the longer number, a product as many as both, and what leading zeros were is
given back. Coordinates are multiples of 2^-1074 below 2^1024, all times one power of
two. The page's words must be those derived or more, and the rooms at least the sum.
"""
import re
import sys

POSITION = (1 << 53) - 1 << 2098 - 53 # the largest binary64 over the smallest
AUDITED = 1 << 60 + 1074 # audit's coordinates are at most 2^60
PAGE, WORD = "spec/narrow/narrow.md", 32


class Arena:
    """Words in use, and the most that there were."""

    def __init__(self):
        self.used = self.most = 0

    def take(self, words, bound):
        """A number made in so many words, of which those that its bound needs stay."""
        self.most = max(self.most, self.used + words)
        number = Number(self, bound)
        self.used += number.words
        return number

    def keep(self, mark, number):
        """Frees all words since `mark` but the number's."""
        self.used = mark + number.words
        return number

    def det(self, a, b, c, d):
        """a·b - c·d"""
        mark = self.used
        p = a * b
        return self.keep(mark, p + c * d)


class Number:
    """A number of which nothing is known but a bound of its size."""

    def __init__(self, arena, bound):
        self.arena, self.bound = arena, bound
        self.words = -(-bound.bit_length() // WORD)

    def __add__(self, other):
        words = max(self.words, other.words) + 1
        return self.arena.take(words, self.bound + other.bound)

    def __mul__(self, other):
        return self.arena.take(self.words + other.words, self.bound * other.bound)

    def times(self, k):
        """k times the number."""
        return self.arena.take(self.words + 1, self.bound * k)


def positions(arena, count, bound=POSITION):
    """Coordinates as integers: big_make takes three words from the lowest bit on."""
    words = bound.bit_length() // WORD + 3
    return [arena.take(words, bound) for _ in range(count)]


def crossed(arena, f, g):
    """set_cross: a component of f × g, whose vectors are linear: its coefficients."""
    made = []
    for n in range(3):
        mark, total = arena.used, None
        for _ in range(2 if n == 1 else 1):
            one = arena.det(f, g, f, g)
            total = one if total is None else total + one
        made.append(arena.keep(mark, total))
    return made


def forms(arena, edges):
    """set_vf or set_ee and set_cubic; returns (words of each part, V)."""
    parts, before = {}, arena.used
    x = positions(arena, 24)
    parts["positions"], before = arena.used - before, arena.used
    f = [x[0] + x[1] for _ in range(42 if edges else 18)][0]
    parts["differences"], before = arena.used - before, arena.used
    for _ in range(3):
        normal = crossed(arena, f, f)
        if edges:
            for _ in range(2):
                form = crossed(arena, f, f)
                for k in range(3):
                    normal[k] + form[k]
        else:
            others = [crossed(arena, f, f) for _ in range(2)]
            for form in others:
                normal = [normal[k] + form[k] for k in range(3)]
    parts["forms"], before = arena.used - before, arena.used
    mark, cubic = arena.used, []
    cross = crossed(arena, f, f)
    arena.used = mark
    for n in range(4):
        mark, total = arena.used, None
        for t in range(1 if n > 2 else 0, 2 if n > 0 else 1):
            for _ in range(3):
                one = f * cross[n - t]
                total = one if total is None else total + one
        cubic.append(arena.keep(mark, total))
    parts["V"] = arena.used - before
    return parts, cubic


def chained(arena, cubic):
    """chains_cubic where V has three roots, and where it has a double one: then its
    discriminant is 0 and has no words, and there are two linear chains. Returns the
    words of the longer way, and the longest number."""
    before = arena.used
    w, z, y, x = cubic
    hessian = [arena.det(z, z, y.times(3), w), arena.det(y, z, x.times(9), w),
               arena.det(y, y, x.times(3), z)]
    quarter = hessian[2].times(4)
    mark = arena.used
    discriminant = arena.det(hessian[1], hessian[1], quarter, hessian[0])
    hessian[2].times(2)
    for k in (1, 2, 3):
        cubic[k].times(k)
    simple, arena.used = arena.used, mark
    slope = hessian[2].times(2)
    first, rest = x * hessian[2], arena.det(y, hessian[2], x, hessian[1])
    for number in (slope, first):
        number.times(1)
    longest = max(discriminant.bound, first.bound, rest.bound)
    return max(simple, arena.used) - before, longest


def of_predicates():
    """The most words of orient3's arena, and of a difference."""
    arena = Arena()
    x = positions(arena, 12, AUDITED)
    r = [x[0] + x[1] for _ in range(9)][0]
    total = None
    for _ in range(3):
        two = arena.det(r, r, r, r)
        one = two * r
        total = one if total is None else total + one
    return arena.most, r.words


def constant(path, name):
    """A number that a file gives a name."""
    with open(path, encoding="utf-8") as file:
        found = re.search(rf"\b{name}\s*(?:=\s*)?(\d+)\b", file.read())
    return int(found[1]) if found else 0


def said(what):
    """The words that the page gives for something."""
    with open(PAGE, encoding="utf-8") as file:
        text = " ".join(file.read().split())
    found = re.search(rf"\b{what} (\d[\d ]*\d)(?= in all|[,:])" if what != "sign"
                      else r"\ba sign (\d+)", text)
    return int(found[1].replace(" ", "")) if found else 0


class Results:
    """Counts checks."""

    def __init__(self):
        self.passed = self.failed = 0

    def at_most(self, name, derived, given):
        """Whether a derived number is within what is given for it."""
        good = 0 < derived <= given
        self.passed += good
        self.failed += not good
        print(f"{'derived' if good else 'FAILED'} {name}: {derived} of {given}")


def main():
    """Derives and checks."""
    results, total = Results(), 0
    arena = Arena()
    parts, cubic = forms(arena, True)
    faces, _ = forms(Arena(), False)
    for name, words in parts.items():
        results.at_most(f"{name}, words", max(words, faces[name]), said(name))
        total += words
    chain, longest = chained(arena, cubic)
    results.at_most("a chain, words", chain, said("a chain"))
    results.at_most("bits of V", max(c.bound.bit_length() for c in cubic), 3 * 2099 + 5)
    results.at_most("bits of the longest number of a chain", longest.bit_length(),
                    16 * 2099)
    total += chain + said("sign")
    for path, name in (("gpu/narrow/narrow.cu", "LONG_ROOM"),
                       ("ref/narrow/exact.h", "EXACT_WORDS")):
        results.at_most(f"a pair, words of {name}", total, constant(path, name))
    most, difference = of_predicates()
    results.at_most("orient3, words of SIGNS_ROOM", most,
                    constant("gpu/narrow/predicates.cuh", "SIGNS_ROOM"))
    results.at_most("a difference of orient3, words of the reference", difference,
                    constant("ref/narrow/predicates.c", "WORDS"))
    print(f"{results.passed} passed, {results.failed} failed")
    return 1 if results.failed or not results.passed else 0


if __name__ == "__main__":
    sys.exit(main())
