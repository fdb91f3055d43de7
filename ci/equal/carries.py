#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves that integers of many words have no lost carry, of any length: what each
step of a loop of ref/narrow/big.c and of gpu/narrow/big.cuh does to a word and to
what it carries on.

usage: ci/equal/carries.py BUILD    ends with `N passed, N failed`

A step is one iteration of the loop, executed symbolically from what clang -O0 makes
of the source, at any index and for any words. Bitwuzla shows that the word which it
writes and the new carry are exactly the sum of the words that it reads and the old
carry, and that the carry stays within its bound. By induction over the steps the words
of the result are those of the exact sum, difference or product: a step adds the same
number on both sides of `result so far + carry · 2^(32 i) = exact result so far`. So
the rows of ref/ and the columns of gpu/ give the same words for every length.
"""
import os
import re
import subprocess
import sys

import llvm
import solver
import words
from logic import both
from run import Memory, State, assume
from term import TABLE, TRUE, integers, leaf

SOURCES = {"ref": "ref/narrow/big.c", "gpu": "gpu/narrow/big.cuh"}
WIDE = 160 # bits in which nothing below overflows
FLAGS = ["-O0", "-fno-discard-value-names", "-w", "-I.", "-Ispec", "-DREAL_BITS=64"]
# What the device's inline functions are called by, so that they are compiled.
USES = """
struct big use_add(struct big_arena *m, struct big a, struct big b)
{
    return big_add(m, a, b);
}
struct big use_mul(struct big_arena *m, struct big a, struct big b)
{
    return big_mul(m, a, b);
}
"""


def compiled(build, side):
    """A side's file as a module."""
    folder = os.path.join(build, "equal")
    os.makedirs(folder, exist_ok=True)
    names = [f"{build}/names/{name}.h" for name in ("ref", "gpu", "tests")]
    subprocess.run(["make", "-s", f"BUILD={build}", *names], check=True)
    text = f'#include "{SOURCES[side]}"\n' + (USES if side == "gpu" else "")
    path = os.path.join(folder, f"carries_{side}")
    source = path + (".cpp" if side == "gpu" else ".c")
    with open(source, "w", encoding="utf-8") as file:
        file.write(text)
    language = ["clang++", "-x", "c++", "-std=gnu++17"] if side == "gpu" else [
        "clang", "-std=c17"]
    subprocess.run([*language, *FLAGS, f"-I{build}", "-S", "-emit-llvm", source, "-o",
                    path + ".ll"], check=True)
    with open(path + ".ll", encoding="utf-8") as file:
        return llvm.Module(file.read())


class Step:
    """One iteration of loop number `loop` of a function; with `end`, what follows that
    loop in an iteration of the one around it. held: the values of its variables before,
    by name and byte, of which "counter" is the loop's; given: what is known of them."""

    def __init__(self, module, name, loop, held, given=TRUE, end=False):
        name = next(n for n in module.functions if re.search(rf"(^|\d){name}(_64)?(P|$)",
                                                             n))
        self.memory, self.state = Memory(), State()
        self.function = llvm.Function(module, name, self.memory)
        blocks = self.function.blocks
        for _, line in next(iter(blocks.values())):
            found = re.match(r"(%[\w.]+) = alloca ", line)
            if found:
                self.state.regs[found[1]] = self.memory.fresh(found[1])
        heads = [block for block in blocks if re.match(r"for\.cond\d*$", block)]
        counter = re.search(r"load i\d+, i\d+\* %(\w+)", blocks[heads[loop]][0][1])[1]
        for (variable, byte), term in held.items():
            variable = counter if variable == "counter" else variable
            self.memory.store(self.state, self.at(variable, byte), term)
        assume(self.state, given, True)
        first = self.function.follow[heads[loop]][1 if end else 0]
        self.state = self.function.run(first, self.state,
                                       self.after(heads[loop - 1 if end else loop]))

    def after(self, head):
        """The block in which an iteration ends: where it counts on."""
        return next(b for b in self.function.blocks if head in self.function.follow[b]
                    and b.startswith("for.inc"))

    def at(self, variable, byte=0):
        """The address of a byte of a variable."""
        return words.add(self.state.regs["%" + variable], words.const(64, byte))

    def local(self, variable, bits):
        """A variable after the step."""
        return self.memory.load(self.state, self.at(variable), bits // 8)

    def word(self, base, index, bits=32):
        """A word of an array after the step."""
        at = words.add(base, words.mul(words.extend_signed(index, 64),
                                       words.const(64, 4)))
        return self.memory.load(self.state, at, bits // 8)


def total(*parts):
    """Σ term · 2^power of (term, power), exactly; a negative sign before a power
    subtracts."""
    result = words.const(WIDE, 0)
    for term, power, sign in parts:
        wide = words.mul(words.extend(term, WIDE), words.const(WIDE, 1 << power))
        result = words.add(result, wide, sign)
    return result


def below(term, most):
    """Whether a term is at most `most`."""
    return words.compare("ule", term, words.const(term.sort[1], most))


class Lemmas:
    """Counts lemmas and tells of each."""

    def __init__(self):
        self.passed = self.failed = 0

    def tell(self, name, good):
        """Counts and prints."""
        self.passed += good
        self.failed += not good
        print(f"{'proved' if good else 'FAILED'} {name}")
        sys.stdout.flush()

    def step(self, name, new, old, bounds, given):
        """A step's numbers: new equals old, and each of bounds holds after."""
        good = solver.are_equal(total(*new), total(*old), given, 60)
        for bound in bounds:
            good = good and solver.are_equal(bound, TRUE, given, 60)
        self.tell(name, good)


def variables():
    """The words and pointers that the steps below share."""
    TABLE.start()
    i, n = leaf("i", integers(32)), leaf("n", integers(32))
    a, b, d = (leaf(name, integers(64)) for name in "abd")
    return i, n, a, b, d


def input_word(base, index, bits=32):
    """A word of an array before the step."""
    memory, state = Memory(), State()
    at = words.add(base, words.mul(words.extend_signed(index, 64), words.const(64, 4)))
    return memory.load(state, at, bits // 8)


def of_sums(lemmas, ref):
    """Sums and differences of the reference, where b has a word and beyond."""
    for within in (True, False):
        i, n, a, b, d = variables()
        carry = leaf("carry", integers(64))
        has = words.compare("slt", i, n)
        has = has if within else words.negate(has)
        pointers = {("a", 0): a, ("b", 0): b, ("b", 8): n, ("d", 0): d, ("i", 0): i}
        given = both(below(carry, 1), has)
        step = Step(ref, "add_magnitudes", 0, {**pointers, ("carry", 0): carry}, has)
        x = input_word(a, i)
        y = input_word(b, i) if within else words.const(32, 0)
        after = step.local("carry", 64)
        lemmas.step(f"ref: a sum's step{' beyond b' * (not within)}",
                    [(step.word(d, i), 0, 1), (after, 32, 1)],
                    [(x, 0, 1), (y, 0, 1), (carry, 0, 1)], [below(after, 1)], given)
        borrow = leaf("borrow", integers(32))
        given = both(below(borrow, 1), has)
        step = Step(ref, "subtract_magnitudes", 0, {**pointers, ("borrow", 0): borrow},
                    has)
        after = step.local("borrow", 32)
        lemmas.step(f"ref: a difference's step{' beyond b' * (not within)}",
                    [(step.word(d, i), 0, 1), (after, 32, -1)],
                    [(x, 0, 1), (y, 0, -1), (borrow, 0, -1)], [below(after, 1)], given)


def of_rows(lemmas, ref):
    """Rows of a product, of one word of a and of two at once."""
    i, _, a, b, d = variables()
    j, k = leaf("j", integers(32)), words.add(i, leaf("j", integers(32)))
    carry, x = leaf("carry", integers(64)), leaf("x", integers(32))
    step = Step(ref, "big_mul", 1, {
        ("a", 0): a, ("b", 0): b, ("d", 0): d, ("i", 0): i, ("j", 0): j,
        ("carry", 0): carry, ("x", 0): words.extend(x, 64)})
    most, after = (1 << 32) - 1, step.local("carry", 64)
    product = words.mul(words.extend(x, 64), words.extend(input_word(b, j), 64))
    lemmas.step("ref: a row's step", [(step.word(d, k), 0, 1), (after, 32, 1)],
                [(product, 0, 1), (input_word(d, k), 0, 1), (carry, 0, 1)],
                [below(after, most)], below(carry, most))
    i, n, a, b, d = variables()
    j, x = leaf("j", integers(32)), leaf("x", integers(64))
    held, most = leaf("t", integers(128)), (1 << 64) - 1
    step = Step(ref, "add_rows", 0, {
        ("b.addr", 0): b, ("d.addr", 0): d, ("j", 0): j, ("t", 0): held,
        ("x.addr", 0): x, ("n.addr", 0): n})
    after = step.local("t", 128)
    product = words.mul(words.extend(x, 128), words.extend(input_word(b, j, 64), 128))
    lemmas.step("ref: a step of two rows", [(step.word(d, j, 64), 0, 1), (after, 64, 1)],
                [(product, 0, 1), (input_word(d, j, 64), 0, 1), (held, 0, 1)],
                [below(after, most)], below(held, most))


def of_columns(lemmas, gpu):
    """The device's sums, and columns of a product."""
    for loop, minus in ((0, 0), (0, 1), (1, 0), (1, 1)):
        k, _, x, y, d = variables()
        carry, flip = leaf("carry", integers(64)), -minus
        step = Step(gpu, "big_carry", loop, {
            ("x", 0): x, ("y", 0): y, ("d", 0): d, ("counter", 0): k,
            ("carry", 0): carry, ("flip", 0): words.const(32, flip)})
        after = step.local("carry", 64)
        other = words.const(32, 0) if loop else input_word(y, k)
        parts = [(input_word(x, k), 0, 1), (carry, 0, 1), (other, 0, -1 if minus else 1)]
        if minus: # ~y = 2^32 - 1 - y
            parts.append((words.const(32, (1 << 32) - 1), 0, 1))
        lemmas.step(f"gpu: a {'difference' if minus else 'sum'}'s step"
                    f"{' beyond b' * loop}",
                    [(step.word(d, k), 0, 1), (after, 32, 1)], parts, [below(after, 1)],
                    below(carry, 1))
    i, _, x, y, d = variables()
    k, held = leaf("k", integers(32)), leaf("sum", integers(64))
    over, most = leaf("over", integers(32)), (1 << 32) - 2
    step = Step(gpu, "big_mul", 1, {
        ("x", 0): x, ("y", 0): y, ("i", 0): i, ("k", 0): k, ("sum", 0): held,
        ("over", 0): over})
    product = words.mul(words.extend(input_word(x, i), 64),
                        words.extend(input_word(y, words.sub(k, i)), 64))
    lemmas.step("gpu: a column's step",
                [(step.local("sum", 64), 0, 1), (step.local("over", 32), 64, 1)],
                [(product, 0, 1), (held, 0, 1), (over, 64, 1)], [], below(over, most))
    ends = Step(gpu, "big_mul", 1, {("d", 0): d, ("k", 0): k, ("sum", 0): held,
                                    ("over", 0): over}, end=True)
    lemmas.step("gpu: a column's end",
                [(ends.word(d, k), 0, 1), (ends.local("sum", 64), 32, 1)],
                [(held, 0, 1), (over, 64, 1)], [], TRUE)


def main(build):
    """Asks all lemmas."""
    ref, gpu = (compiled(build, side) for side in ("ref", "gpu"))
    lemmas = Lemmas()
    of_sums(lemmas, ref)
    of_rows(lemmas, ref)
    of_columns(lemmas, gpu)
    print(f"{lemmas.passed} passed, {lemmas.failed} failed")
    return 1 if lemmas.failed or not lemmas.passed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
