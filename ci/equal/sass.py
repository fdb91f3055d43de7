#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves that machine code performs the operations of ref/: SASS, as nvdisasm prints
it, of device functions without branches and calls.

usage: ci/equal/sass.py BUILD [NVDISASM]    ends with `N passed, N failed, N skipped`

It shows for ROWS what spec/proofs.md assumes of ptxas: that the machine code has the
operations of the PTX. Of SASS, which NVIDIA does not define, the meaning is what the
names say; an instruction, modifier or operand that is not listed here is refused. A
division or a root is many instructions, or a call, and is not read. nvdisasm is PyPI's nvidia-cuda-nvdisasm; where it is missing all is skipped.
"""
import glob
import os
import re
import shutil
import struct
import subprocess
import sys

import compare
import floats
import prove
import question
import table
import words
from logic import both, choose, either, negate
from term import TABLE, TRUE, Unsupported, integers, leaf

ROWS = ("min_of", "max_of", "cross", "axpy", "apply", "add_sym", "wide_cross",
        "wide_axpy", "wide_dot", "narrowed", "magnitude", "cross_form", "restrict_form",
        "restrict_cubic", "cubic_at", "between", "axis_forms")
FIRST = 0x210 # where parameters begin in the bank of constants, on sm_90
LINE = re.compile(r"\s*/\*[0-9a-f]{4,}\*/\s+(?:@(!?)(U?P\d|U?PT)\s+)?([A-Z0-9_.]+)\s*(.*?)\s*;")
ADDRESS = re.compile(r"desc\[UR\d+\]\[(R\d+)\.64(?:\+(-?0x[0-9a-f]+))?\]")
SIZES = {"64": 2, "128": 4}


class Machine:
    """Executes the instructions of a function, one after the other."""

    def __init__(self, memory, bank, state):
        self.memory, self.bank, self.state = memory, bank, state

    def word(self, name):
        """A register of 32 bits."""
        if name in ("RZ", "URZ"):
            return words.const(32, 0)
        if name not in self.state.regs:
            raise Unsupported("a register without a value: " + name)
        return self.state.regs[name]

    def constant(self, at):
        """A word of the bank of constants."""
        if at < FIRST:
            return leaf(("bank", at), integers(32))
        if at not in self.bank:
            raise Unsupported(f"c[0x0][{at:#x}] is no parameter")
        return self.bank[at]

    @staticmethod
    def after(name, k):
        """The register k places on."""
        found = re.fullmatch(r"(U?R)(\d+)", name)
        return name if not found else f"{found[1]}{int(found[2]) + k}"

    def parts(self, text, count):
        """So many words of an operand, the lowest first."""
        at = re.fullmatch(r"c\[0x0\]\[(0x[0-9a-f]+)\]", text)
        if at:
            return [self.constant(int(at[1], 16) + 4 * k) for k in range(count)]
        if re.fullmatch(r"0x[0-9a-f]+", text) and count == 1:
            return [words.const(32, int(text, 16))]
        if not re.fullmatch(r"U?R(?:\d+|Z)", text):
            raise Unsupported("operand " + text)
        return [self.word(self.after(text, k)) for k in range(count)]

    def number(self, text, sort):
        """An operand that is a number, with its sign and size."""
        if re.fullmatch(r"-?(?:\d+\.?\d*(?:e[+-]?\d+)?)", text):
            return floats.const(sort, float(text))
        sign, text = text.startswith("-"), text.removeprefix("-")
        size, text = text.startswith("|"), text.strip("|")
        held = self.parts(text, 2 if sort == "f64" else 1)
        whole = words.join(held[1], held[0]) if sort == "f64" else held[0]
        found = floats.number(whole, sort)
        found = floats.size(found) if size else found
        return floats.neg(found) if sign else found

    def put(self, name, term):
        """Writes a register, or two."""
        if not isinstance(term.sort, tuple):
            term = floats.bits(term)
        for k in range(term.sort[1] // 32):
            self.state.regs[self.after(name, k)] = words.cut(term, 32 * k, 32)

    def truth(self, name):
        """A predicate."""
        bare = name.removeprefix("!")
        found = TRUE if bare in ("PT", "UPT") else self.state.regs.get(bare)
        if found is None:
            raise Unsupported("a predicate without a value: " + bare)
        return negate(found) if name.startswith("!") else found

    def address(self, text):
        """An address in global memory."""
        found = ADDRESS.fullmatch(text)
        if not found:
            raise Unsupported("address " + text)
        low, high = self.parts(found[1], 2)
        return words.add(words.join(high, low), words.const(64, int(found[2] or "0", 16)))

    def step(self, kind, mods, args):
        """Executes an instruction."""
        if kind in ("LDC", "ULDC") and mods in ([], ["64"]):
            for k, part in enumerate(self.parts(args[1], 2 if mods else 1)):
                self.put(self.after(args[0], k), part)
        elif kind in ("LDG", "STG") and mods[:1] == ["E"] and (
                set(mods[1:]) <= {"64", "128", "CONSTANT"}):
            self.move(kind, SIZES.get((mods[1:2] or [""])[0], 1), args)
        elif kind in ("FADD", "FMUL", "FFMA", "DADD", "DMUL", "DFMA") and not mods:
            sort = "f32" if kind[0] == "F" else "f64"
            operands = [self.number(a, sort) for a in args[1:]]
            operation = {"ADD": floats.add, "MUL": floats.mul, "FMA": floats.fma}
            self.put(args[0], operation[kind[1:]](*operands))
        elif kind == "F2F" and mods in (["F64", "F32"], ["F32", "F64"]):
            sorts = [m.lower() for m in mods]
            self.put(args[0], floats.convert(self.number(args[1], sorts[1]), sorts[0]))
        elif kind == "MOV" and not mods:
            self.put(args[0], self.parts(args[1], 1)[0])
        elif kind == "IMAD" and mods == ["MOV", "U32"] and args[1:3] == ["RZ", "RZ"]:
            self.put(args[0], self.parts(args[3], 1)[0])
        else:
            self.choose(kind, mods, args)

    def choose(self, kind, mods, args):
        """Executes a comparison or what depends on one."""
        if kind in ("FSETP", "DSETP") and len(mods) == 2 and args[1] == "PT":
            sort = "f32" if kind[0] == "F" else "f64"
            a, b = (self.number(x, sort) for x in args[2:4])
            join = {"AND": both, "OR": either}.get(mods[1])
            if not join:
                raise Unsupported(".".join([kind, *mods]))
            found = floats.relation(mods[0].lower(), a, b)
            self.state.regs[args[0]] = join(found, self.truth(args[4]))
        elif kind in ("FSEL", "SEL") and not mods:
            a, b = (floats.bits(self.number(x, "f32")) if re.match(r"[-|]", x)
                    else self.parts(x, 1)[0] for x in args[1:3])
            self.put(args[0], choose(self.truth(args[3]), a, b))
        elif kind == "HFMA2" and mods == ["MMA"] and args[1:3] == ["-RZ", "RZ"]:
            high, low = (struct.unpack("<H", struct.pack("<e", float(x)))[0]
                         for x in args[3:]) # what is added to -0 · 0 is a constant
            self.put(args[0], words.const(32, high << 16 | low))
        else:
            raise Unsupported(".".join([kind, *mods]))

    def move(self, kind, count, args):
        """Reads or writes global memory."""
        register, place = args if kind == "LDG" else args[::-1]
        at = self.address(place)
        for k in range(count):
            there = words.add(at, words.const(64, 4 * k))
            name = self.after(register, k)
            if kind == "LDG":
                self.put(name, self.memory.load(self.state, there, 4))
            else:
                self.memory.store(self.state, there, self.word(name))

    def run(self, text):
        """Executes a function up to its end."""
        for line in text.split("\n"):
            found = LINE.match(line)
            if not found:
                if ";" in line:
                    raise Unsupported("line " + line.strip())
                continue
            _, predicate, name, rest = found.groups()
            kind, *mods = name.split(".")
            if predicate:
                raise Unsupported(f"@{predicate} {name}")
            if kind == "EXIT":
                return self.state
            if kind != "NOP":
                args = [a.strip().replace(".reuse", "") for a in rest.split(",")]
                self.step(kind, mods, args)
        raise Unsupported("a function without an end")


def bank_of(twin, bits):
    """The parameters of a wrapper as words of the bank of constants."""
    bank, at = {}, FIRST
    for kind, name in twin.params:
        held, _ = question.argument(kind, name, bits)
        held = held if isinstance(held.sort, tuple) else floats.bits(held)
        size = held.sort[1] // 8
        if size < 4:
            raise Unsupported("a parameter of less than a word")
        at = -(-at // size) * size
        for k in range(size // 4):
            bank[at + 4 * k] = words.cut(held, 32 * k, 32)
        at += size
    return bank


def nvdisasm(build):
    """The program, on the path or of the solver's environment."""
    inside = os.path.join(build, "equal/venv/lib/python*/site-packages/nvidia/*/bin")
    return shutil.which("nvdisasm") or next(
        iter(glob.glob(os.path.join(inside, "nvdisasm"))), None)


def listing(build, program, twin, bits):
    """A row's function as nvdisasm prints it."""
    path = f"{build}/equal/{twin.group.name}.{bits}.cubin"
    said = subprocess.run([program, "-c", path], capture_output=True, text=True,
                          check=False).stdout
    name = re.escape(f".text.twin_{twin.name}:")
    found = re.search(rf"^{name}\n(.*?)(?=^\t\.section|\Z)", said, re.M | re.S)
    if not found:
        raise Unsupported("no section of this name")
    return found[1]


def verdict_on(build, program, twin, bits):
    """Whether the machine code of a row is its reference."""
    def machine(memory, start):
        return Machine(memory, bank_of(twin, bits), start.copy()).run(text)
    try:
        text = listing(build, program, twin, bits)
        for zeros in (False, True):
            TABLE.start(zeros)
            pairs, given = question.question(build, twin, bits, machine=machine)
            verdict = compare.decide(pairs, given, True, os.path.relpath,
                                     ("reference", "machine"))
            if verdict.kind != "open":
                break
        return verdict
    except Unsupported as why:
        return compare.Verdict("open", str(why))


def main(build, program=None):
    """Proves all rows."""
    program = program or nvdisasm(build)
    if not program:
        print("skipped: machine code: there is no nvdisasm (pip: nvidia-cuda-nvdisasm)")
        print("0 passed, 0 failed, 1 skipped")
        return 0
    twins = [t for g in table.read(prove.TWINS) for t in g.twins if t.name in ROWS]
    groups = sorted({t.group.name for t in twins})
    cubins = [f"{build}/equal/{name}.{bits}.cubin" for name in groups
              for bits in prove.BITS]
    good = prove.compile_all(build, twins, prove.BITS, 2) and len(twins) == len(ROWS)
    good = good and subprocess.run(["make", "-s", f"BUILD={build}", *cubins],
                                   check=False).returncode == 0
    results = [good]
    for twin in twins if good else ():
        for bits in prove.BITS:
            verdict = verdict_on(build, program, twin, bits)
            equal = verdict.kind == "equal"
            results.append(equal)
            print(f"{'proved' if equal else 'FAILED'} {twin.name} {bits} of machine "
                  f"code: {verdict.kind}, {verdict.how}", *verdict.detail, sep="\n    ")
    print(f"{results.count(True)} passed, {results.count(False)} failed, 0 skipped")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
