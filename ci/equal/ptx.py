# SPDX-License-Identifier: Apache-2.0
"""PTX as nvcc prints it, executed: each instruction's meaning is the PTX ISA's."""
import collections
import re

import floats
import words
from logic import both, choose, differ, either, negate
from run import EXIT, Machine, State, postdominators, widen
from term import (FALSE, TABLE, TRUE, Unsupported, integers, is_float, leaf, make,
                  signed, width)

ENTRY = re.compile(r"\.(?:entry|func)\s*(\(\s*\.param[^)]*\))?\s*([\w$]+)\s*\(([^()]*)\)"
                   r"((?:(?!\.entry|\.func)[^{;])*)\n\{(.*?)\n\}", re.S)
PLACE = re.compile(r"\.loc\s+(\d+)\s+(\d+)[^\n]*")
JUMP = re.compile(r"(?:@(!?)(%p\d+)\s+)?(bra|ret)(?:\.uni)?\s*([\w$]*)$")
MEET = re.compile(r"(?:bar|barrier|shfl)\.")
FLOAT = {"add": floats.add, "sub": floats.sub, "mul": floats.mul, "div": floats.div,
         "sqrt": floats.root, "neg": floats.neg, "abs": floats.size,
         "min": floats.least, "max": floats.most, "mov": lambda a: a,
         "fma": floats.fma, "rcp": lambda a: floats.div(floats.const(a.sort, 1.0), a)}
WHOLE = {"add": words.add, "sub": words.sub, "and": words.conjunction,
         "or": words.disjunction, "xor": words.difference, "mov": lambda a: a,
         "neg": lambda a: words.sub(words.const(a.sort[1], 0), a),
         "not": lambda a: words.difference(a, words.const(a.sort[1], -1))}
TRUTH = {"and": both, "or": either, "not": negate, "xor": differ, "mov": lambda a: a}


Base = collections.namedtuple("Base", "at")  # of the memory that a parameter is


class File:
    """The functions and variables of a PTX file. loose: sums and products without .rn
    have a meaning, too."""

    def __init__(self, text, loose=False):
        self.loose = loose
        self.functions = {m[2]: m for m in ENTRY.finditer(text)}
        self.files = dict(re.findall(r'^\s*\.file\s+(\d+)\s+"([^"]*)"', text, re.M))
        self.globals = set(re.findall(
            r"^\.(?:visible |extern |weak )*\.?(?:shared|global|const)[^\n;]*?"
            r"\b(\w+)(?:\[\d*\])?(?: = [^\n;]*)?;", text, re.M))
        self.shared = re.findall(r"^\.(?:visible |extern |weak )*\.?shared[^\n;]*?"
                                 r"\b(\w+)(?:\[\d*\])?;", text, re.M)


def sort_of(kind):
    """The sort of a PTX type."""
    if kind in ("f32", "f64"):
        return kind
    return "b" if kind == "pred" else integers(int(re.search(r"\d+", kind)[0]))


def as_sort(a, sort):
    """A register's value read as another type of any size."""
    if a.sort == sort:
        return a
    if is_float(a.sort):
        a = floats.bits(a)
    if is_float(sort) and a.sort == integers(width(sort)):
        return floats.number(a, sort)
    if isinstance(sort, tuple) and isinstance(a.sort, tuple):
        if a.sort[1] >= sort[1]:
            return words.cut(a, 0, sort[1])
        return words.extend(a, sort[1])
    raise Unsupported(f"a register of {a.sort} read as {sort}")


def in_register(name, a, kind):
    """What a load of this type leaves in a register, which may be wider."""
    found = re.match(r"%(rd|rs|r)\d", name)
    if not found or is_float(a.sort):
        return a
    bits = {"rd": 64, "r": 32, "rs": 16}[found[1]]
    return (words.extend_signed if kind[0] == "s" else words.extend)(a, bits)


class Function(Machine):
    """A function or kernel. params: what its parameters hold, in order: a value; a
    dictionary of values by byte; or the Base of memory that holds a struct. hooks:
    part of a name to a function that stands for the callee. threads: what %tid.x and
    others are, where they are not any number. together: whether the threads of a block
    are executed together (together.py), so that they may exchange values."""

    def __init__(self, file, name, memory, params, hooks=None, threads=None,
                 together=False):
        super().__init__(memory)
        self.threads, self.together, self.variables = threads or {}, together, []
        if name not in file.functions:
            raise Unsupported("no function " + name)
        found = file.functions[name]
        self.file, self.hooks, self.space = file, hooks or {}, {}
        self.returns = re.search(r"(\w+)(?:\[\d+\])?\s*\)$", found[1])[1] if (
            found[1]) else None
        names = re.findall(r"([\w$]+)(?:\[\d+\])?\s*(?:,|$)", found[3].strip())
        self.params = dict(zip(names, params))
        self.blocks, self.follow = {}, {}
        self.read(found[5])
        self.meets = postdominators(self.follow)

    def read(self, body):
        """Splits the body into blocks of (place, statement)."""
        body = re.sub(r"//[^\n]*", "", body)
        body = PLACE.sub(r";.loc \1 \2;", body)
        body = re.sub(r"\.pragma[^\n]*|^\s*[{}]\s*$", "", body, flags=re.M)
        body = re.sub(r"^\s*(\$[\w$]+):", r";\1:;", body, flags=re.M)
        block, place = "entry", None
        self.blocks[block] = []
        for line in body.split(";"):
            line = " ".join(line.split())
            variable = re.match(r"\.(local|shared) .*?([\w$]+) ?(?:\[\d+\])?$", line)
            if variable:
                self.variables.append(variable.groups())
                self.space[variable[2]] = self.memory.fresh(variable[2])
            elif line.startswith(".loc"):
                number, row = line.split()[1:]
                place = self.file.files.get(number, number), row
            elif line.startswith("$") and line.endswith(":"):
                block = line[:-1]
                self.blocks[block] = []
            elif line and not line.startswith("."):
                if MEET.match(line) and self.together:
                    block += "&"
                    self.apart.add(block)
                    self.blocks[block] = []
                self.blocks[block].append((place, line))
                if JUMP.match(line):
                    block += "'"
                    self.blocks[block] = []
        names = list(self.blocks)
        for name, after in zip(names, [*names[1:], EXIT]):
            lines = self.blocks[name]
            jump = JUMP.match(lines[-1][1]) if lines else None
            if not jump:
                self.follow[name] = [after]
                continue
            to = EXIT if jump[3] == "ret" else jump[4]
            self.follow[name] = [to, after] if jump[2] else [to]

    def go(self, state):
        """Executes the function."""
        return self.run("entry", state)

    def value(self, state, text, sort):
        """An operand."""
        if text in state.regs:
            return state.regs[text]
        if re.match(r"0[fd][0-9A-F]+$", text):
            return floats.of_bits("f32" if text[1] == "f" else "f64", int(text[2:], 16))
        if re.match(r"-?\d+$", text):
            if sort == "b":
                return TRUE if int(text) else FALSE
            if is_float(sort):
                return floats.const(sort, float(text))
            return words.const(sort[1], int(text))
        if text in self.space:
            at = self.space[text]
            return at if sort == integers(64) else words.cut(at, 0, sort[1])
        if text in self.file.globals:
            return leaf("global " + text, integers(64))
        if isinstance(self.params.get(text), Base):
            return self.params[text].at
        if re.match(r"%(tid|ctaid|ntid|nctaid|laneid)", text):
            return self.threads.get(text) or leaf(text, integers(32))
        if text.startswith("%"):
            return leaf("nothing in " + text, sort)
        raise Unsupported("operand " + text)

    def block(self, name, state):
        """Executes the block; returns its condition and successors."""
        follow = self.follow[name]
        for place, line in self.blocks[name]:
            jump = JUMP.match(line)
            if jump:
                if not jump[2]:
                    return TRUE, follow
                condition = state.regs[jump[2]]
                return negate(condition) if jump[1] else condition, follow
            found = re.match(r"([\w.:]+)\s*(.*)$", line)
            if not found:
                raise Unsupported(line)
            before = len(TABLE.terms)
            self.statement(state, found[1], found[2])
            TABLE.origin.update((k, place) for k in range(before, len(TABLE.terms)))
        return TRUE, follow

    def statement(self, state, code, rest):
        """Executes one instruction."""
        kind, *parts = code.split(".")
        args = [word.strip() for word in re.split(r",(?![^{\[]*[}\]])", rest)]
        if kind in ("bar", "barrier", "membar", "fence"):
            return
        if kind == "shfl":
            state.regs[args[0].partition("|")[0]] = state.regs.pop("from another lane")
            return
        if kind == "call":
            self.call(state, rest)
        elif kind in ("ld", "ldu"):
            self.load(state, parts, args)
        elif kind == "st":
            self.store(state, parts, args)
        elif kind == "atom" and parts[:2] == ["shared", "add"] and self.together:
            self.count(state, sort_of(parts[-1]), args)
        elif kind == "mov" and "{" in rest:
            self.move_parts(state, sort_of(parts[-1]), args)
        else:
            state.regs[args[0]] = self.result(state, kind, parts, args[1:])

    def address(self, state, text):
        """The name or register in an address, and the constant."""
        found = re.match(r"\[([^\]+]+)(?:\+(-?\d+))?\]", text)
        return found[1].strip(), int(found[2] or 0)

    def place(self, state, name):
        """What a register that holds an address has. One of 32 bits is of shared
        memory, of which 2^32 bytes are addressed as are all."""
        at = self.value(state, name, integers(64))
        if at.sort == integers(64):
            return at
        return self.widened(at)

    def widened(self, at):
        """An address of shared memory in 64 bits. One that depends on a condition is the
        choice of two."""
        of, constant = words.parts(at)
        result = words.const(64, signed(constant, 32))
        for term, factor in of.items():
            if term.op == "choice" and factor == 1:
                condition, *sides = term.args
                wide = choose(condition, *map(self.widened, sides))
                result = words.add(result, wide)
                continue
            inner = term.args[0] if term.op == "cut" and term.args[1] == 0 else term
            known = factor == 1 and inner.sort == integers(64)
            wide = inner if known else words.extend_signed(term, 64)
            result = words.add(result, wide, 1 if known else signed(factor, 32))
        return result

    def load(self, state, parts, args):
        """ld, of one or more registers."""
        sort, (name, byte) = sort_of(parts[-1]), self.address(state, args[1])
        count = width(sort) // 8
        targets = re.findall(r"%\w+", args[0])
        held = state.regs.get("param " + name, self.params.get(name))
        for k, target in enumerate(targets):
            at = byte + k * count
            if isinstance(held, dict):
                found = held[at]
            elif held is not None and not isinstance(held, Base):
                found = held
            else:
                base = self.place(state, name)
                found = self.memory.load(state, words.add(base, words.const(64, at)),
                                         count)
            state.regs[target] = in_register(target, as_sort(found, sort), parts[-1])

    def store(self, state, parts, args):
        """st, of one or more registers."""
        sort, (name, byte) = sort_of(parts[-1]), self.address(state, args[0])
        count = width(sort) // 8
        sources = re.findall(r"[%\w.$\-]+", args[1].strip("{}"))
        for k, source in enumerate(sources):
            new = as_sort(self.value(state, source, sort), sort)
            if parts[0] == "param":
                key = "param " + name
                held = dict(state.regs.get(key) or {})
                held[byte + k * count] = new
                state.regs[key] = held
                continue
            base = self.place(state, name)
            to = words.add(base, words.const(64, byte + k * count))
            self.memory.store(state, to, floats.bits(new) if is_float(sort) else new)

    def count(self, state, sort, args):
        """An atomic sum in shared memory, in the order in which threads are executed."""
        name, byte = self.address(state, args[1])
        at = words.add(self.place(state, name), words.const(64, byte))
        old = self.memory.load(state, at, width(sort) // 8)
        state.regs[args[0]] = in_register(args[0], old, "u32")
        self.memory.store(state, at, words.add(old, self.value(state, args[2], sort)))

    def move_parts(self, state, sort, args):
        """mov between a register and several that are its parts."""
        if args[0].startswith("{"):
            targets = re.findall(r"[%\w]+", args[0])
            whole = as_sort(self.value(state, args[1], sort), sort)
            bits = whole.sort[1] // len(targets)
            for k, target in enumerate(targets):
                if target != "_":
                    state.regs[target] = words.cut(whole, k * bits, bits)
            return
        sources = re.findall(r"[%\w]+", args[1])
        part, whole = integers(sort[1] // len(sources)), None
        for source in sources:
            piece = as_sort(self.value(state, source, part), part)
            whole = piece if whole is None else words.join(piece, whole)
        state.regs[args[0]] = whole

    def operands(self, state, args, sort):
        """The values of operands of one type."""
        return [as_sort(self.value(state, text, sort), sort) for text in args]

    def result(self, state, kind, parts, args):
        """What an instruction with one result computes."""
        last = parts[-1] if parts else ""
        sort = sort_of(last)
        if kind == "setp":
            a, b = self.operands(state, args, sort)
            if len(parts) != 2:
                raise Unsupported("setp." + ".".join(parts))
            if is_float(sort):
                return floats.relation(parts[0], a, b)
            return words.relation(parts[0], a, b, last[0] == "s")
        if kind == "selp":
            a, b = self.operands(state, args[:2], sort)
            return choose(self.value(state, args[2], "b"), a, b)
        if kind == "cvta":
            return self.value(state, args[0], integers(64))
        if kind == "cvt":
            return self.converted(state, parts, args[0])
        if kind in ("mul", "mad") and parts[0] == "wide":
            half, full = sort, integers(2 * sort[1])
            a, b = [widen(state, x, full[1], last[0] == "s")
                    for x in self.operands(state, args[:2], half)]
            more = self.operands(state, args[2:], full)
            return words.add(words.mul(a, b), more[0]) if more else words.mul(a, b)
        if kind in ("shl", "shr"):
            return self.shifted(state, kind, last, args)
        if kind == "bfi":
            a, b = self.operands(state, args[:2], sort)
            if not all(map(str.isdigit, args[2:])):
                raise Unsupported("bfi of registers")
            return words.insert(a, b, *map(int, args[2:]))
        a = self.operands(state, args, sort)
        if is_float(sort):
            return self.of_floats(kind, parts, a)
        if sort == "b":
            if kind not in TRUTH:
                raise Unsupported(kind)
            return TRUTH[kind](*a)
        return self.of_words(kind, parts, a)

    def of_floats(self, kind, parts, a):
        """An operation on numbers, of those that ci/equal/lint.py lets pass, or a sum
        with a product that is rounded once."""
        if self.file.loose and kind in ("add", "sub", "mul") and len(parts) == 1:
            return self.contracted(kind, *a)
        rounds = kind in ("add", "sub", "mul", "div", "sqrt", "rcp", "fma")
        if kind not in FLOAT or parts[:-1] != ["rn"] * rounds:
            raise Unsupported(".".join([kind, *parts]))
        return FLOAT[kind](*a)

    @staticmethod
    def contracted(kind, a, b):
        """A sum or product without .rn: PTX lets ptxas contract it, and it is taken as
        contracted where it may be."""
        memo = TABLE.memos["loose"]
        if kind == "mul":
            product = floats.mul(a, b)
            memo[product.id] = memo[floats.neg(product).id] = a, b
            return product
        b = floats.neg(b) if kind == "sub" else b
        for product, other in ((a, b), (b, a)):
            if product.id in memo:
                sign = product.op == "neg"
                x, y = memo[product.id]
                return floats.fma(floats.neg(x) if sign else x, y, other)
        return floats.add(a, b)

    def of_words(self, kind, parts, a):
        """An operation on integers."""
        last = parts[-1]
        if kind in ("min", "max"):
            below = words.compare("slt" if last[0] == "s" else "ult", a[0], a[1])
            return choose(below, *(a if kind == "min" else reversed(a)))
        if kind == "mul" and parts[0] == "lo":
            return words.mul(*a)
        if kind == "mad" and parts[0] == "lo":
            return words.add(words.mul(a[0], a[1]), a[2])
        if kind == "mul" and parts[0] == "hi" and a[0].sort[1] < 64:
            bits, wide = a[0].sort[1], words.extend_signed if last[0] == "s" else (
                words.extend)
            return words.cut(words.mul(*(wide(x, 2 * bits) for x in a)), bits, bits)
        if kind == "prmt" and len(parts) == 1 and words.is_const(a[2]):
            return words.permuted(words.join(a[1], a[0]), a[2].args[0])
        if kind == "abs":
            return words.size(a[0])
        if kind in ("div", "rem"):
            return words.divide(last[0] + kind, *a)
        if kind in WHOLE and len(parts) == 1:
            return WHOLE[kind](*a)
        if kind in ("popc", "clz", "brev") and len(parts) == 1:
            return make("." .join([kind, *parts]), tuple(a), a[0].sort)
        raise Unsupported(".".join([kind, *parts]))

    def shifted(self, state, kind, last, args):
        """shl and shr, whose second operand always has 32 bits."""
        sort = sort_of(last)
        (a,) = self.operands(state, args[:1], sort)
        (by,) = self.operands(state, args[1:], integers(32))
        by = words.extend(by, sort[1]) if sort[1] > 32 else words.cut(by, 0, sort[1])
        if kind == "shl":
            return words.shift_left(a, by)
        return (words.shift_signed if last[0] == "s" else words.shift_right)(a, by)

    def converted(self, state, parts, text):
        """cvt"""
        kind, to, modes = parts[-1], sort_of(parts[-2]), parts[:-2]
        sort = sort_of(kind)
        a = as_sort(self.value(state, text, sort), sort)
        if is_float(sort) and is_float(to) and sort != to and modes in ([], ["rn"]):
            return floats.convert(a, to)
        if is_float(to) and not is_float(sort) and modes == ["rn"]:
            return floats.of_int(a, to, kind[0] == "s")
        if is_float(sort) and not is_float(to) and modes == ["rzi"]:
            return floats.to_int(a, to[1], parts[-2][0] == "s")
        if not is_float(sort) and not is_float(to) and not modes:
            if to[1] <= sort[1]:
                return words.cut(a, 0, to[1])
            return widen(state, a, to[1], kind[0] == "s")
        raise Unsupported("cvt." + ".".join(parts))

    def call(self, state, rest):
        """A call, of a hook or of a function in the file."""
        found = re.match(r"(?:\((\w+)\), )?([\w$]+), \((.*)\)$", rest)
        if not found:
            raise Unsupported("call " + rest)
        result, name, names = found.groups()
        held = [state.regs["param " + text.strip()] for text in names.split(",")]
        for part, hook in self.hooks.items():
            if part in name:
                state.regs["param " + result] = {0: hook(self, state, held)}
                return
        callee = Function(self.file, name, self.memory, held, self.hooks, self.threads,
                          self.together)
        caller, state.regs = state.regs, {}
        ended = callee.run("entry", state)
        if result:
            caller["param " + result] = ended.regs["param " + callee.returns]
        state.memory, state.known, state.regs = ended.memory, ended.known, caller


def execute(file, name, memory, params, state=None, hooks=None, threads=None):
    """Executes a function; returns the state that it leaves."""
    return Function(file, name, memory, params, hooks, threads).go(state or State())
