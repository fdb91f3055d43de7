# SPDX-License-Identifier: Apache-2.0
"""LLVM's intermediate language as clang 14 writes it at -O0, executed. At -O0 no
optimiser has to be trusted, and each statement of C is there."""
import functools
import re

import floats
import words
from logic import both, differ, either, negate, truth
from run import EXIT, Machine, State, merge_values, postdominators, widen
from term import TABLE, TRUE, Unsupported, integers, is_float, leaf

TYPE = re.compile(r"%[\w.]+|i\d+|float|double|void|opaque|metadata|label|\.\.\.")
DEFINED = re.compile(r"^define [^\n]*?@([\w.]+)\(([^\n]*)\)[^\n()]*\{\n(.*?)^\}",
                     re.M | re.S)
ATTRIBUTE = re.compile(r"\b(?:noundef|nonnull|nocapture|readonly|noalias|writeonly|"
                       r"immarg|signext|zeroext|align \d+|dereferenceable\(\d+\)|"
                       r"(?:byval|sret)\([^)]*\))\s*")
RELATION = {"olt": "lt", "ole": "le", "ogt": "gt", "oge": "ge", "oeq": "eq",
            "one": "ne", "ult": "ltu", "ule": "leu", "ugt": "gtu", "uge": "geu",
            "ueq": "equ", "une": "neu", "ord": "num", "uno": "nan"}
FLOAT = {"fadd": floats.add, "fsub": floats.sub, "fmul": floats.mul, "fdiv": floats.div}
WHOLE = {"add": words.add, "sub": words.sub, "mul": words.mul,
         "shl": words.shift_left, "lshr": words.shift_right,
         "ashr": words.shift_signed, "and": words.conjunction,
         "or": words.disjunction, "xor": words.difference}
TRUTH = {"and": both, "or": either, "xor": differ}
CASTS = ("bitcast", "trunc", "zext", "sext", "fpext", "fptrunc", "sitofp", "uitofp",
         "fptosi", "fptoui", "ptrtoint", "inttoptr")
CALLS = {"abs": words.size, "sqrt": floats.root, "sqrtf": floats.root, "fabs": floats.size,
         "fabsf": floats.size}


@functools.cache
def split(text):
    """What a list has between its outermost commas."""
    parts, depth, part = [], 0, ""
    for letter in text:
        depth += (letter in "([{<") - (letter in ")]}>")
        if letter == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += letter
    return (*parts, part.strip()) if part.strip() else tuple(parts)


@functools.cache
def taken_apart(line):
    """The register that a statement sets or None, its word and its operands."""
    target, rest = re.match(r"(?:(%[\w.\-]+) = )?(.*)", line).groups()
    word, _, args = rest.partition(" ")
    if word in ("tail", "notail", "musttail"):
        word, _, args = args.partition(" ")
    return target, word, args


def remembered(method):
    """A method of a module that is asked the same again and again."""
    @functools.wraps(method)
    def ask(self, *args):
        key = (method.__name__, *args)
        if key not in self.memo:
            self.memo[key] = method(self, *args)
        return self.memo[key]
    return ask


class Module:
    """The types, functions and variables of a file. A type is "float", "double",
    "void", ("int", bits), ("pointer", type), ("array", n, type), ("struct", types),
    ("named", name) or ("function",)."""

    def __init__(self, text):
        self.memo = {}
        self.linked = () # modules that have functions which this one calls
        self.types = dict(re.findall(r"^(%[\w.]+) = type (.*)$", text, re.M))
        self.functions = {m[1]: (m[2], m[3]) for m in DEFINED.finditer(text)}
        self.globals = dict(re.findall(
            r"^@([\w.]+) = .*?(?:constant|global) (.*?)(?:, align \d+)?"
            r"(?:, !dbg !\d+)?$", text, re.M))
        self.notes = dict(re.findall(r"^!(\d+) = (.*)$", text, re.M))

    def place(self, number):
        """The file and line of a location."""
        note = self.notes.get(number, "")
        line = re.search(r"line: (\d+)", note)
        for _ in range(20):
            file = re.search(r"file: !(\d+)", note)
            if file:
                name = re.search(r'filename: "([^"]*)"', self.notes[file[1]])
                return name[1], line[1] if line else "0"
            scope = re.search(r"scope: !(\d+)", note)
            if not scope:
                break
            note = self.notes[scope[1]]
        return None

    @remembered
    def parse(self, text, at=0):
        """The type that begins in a text, and where it ends."""
        while text[at] == " ":
            at += 1
        if text[at] in "[<":
            head = re.compile(r"[\[<]\s*(\d+) x ").match(text, at)
            inner, end = self.parse(text, head.end())
            kind, end = ("array", int(head[1]), inner), end + 1
        elif text[at] == "{":
            end, inner = at + 1, []
            while text[end:].lstrip(" ,")[0] != "}":
                end += len(text[end:]) - len(text[end:].lstrip(" ,"))
                member, end = self.parse(text, end)
                inner.append(member)
            kind, end = ("struct", tuple(inner)), text.index("}", end) + 1
        else:
            found = TYPE.match(text, at)
            if not found:
                raise Unsupported("type " + text[at:])
            word, end = found[0], found.end()
            kind = ("named", word) if word[0] == "%" else word
            if re.match(r"i\d", word):
                kind = ("int", int(word[1:]))
        while True:
            if text[end:end + 1] == "*":
                kind, end = ("pointer", kind), end + 1
            elif text[end:end + 2] == " (":
                depth, end = 1, end + 2
                while depth:
                    depth += (text[end] == "(") - (text[end] == ")")
                    end += 1
                kind = ("function",)
            else:
                return kind, end

    @remembered
    def operand(self, text):
        """The type and the name that a type and an operand in one text have."""
        kind, end = self.parse(text)
        return kind, ATTRIBUTE.sub("", text[end:])

    @remembered
    def resolved(self, kind):
        """A type without its name."""
        while kind[0] == "named":
            kind, _ = self.parse(self.types[kind[1]])
        return kind

    @remembered
    def align(self, kind):
        """The alignment of a type, in bytes."""
        kind = self.resolved(kind)
        if kind[0] == "array":
            return self.align(kind[2])
        if kind[0] == "struct":
            return max((self.align(member) for member in kind[1]), default=1)
        return self.size(kind)

    @remembered
    def size(self, kind):
        """The size of a type, in bytes."""
        kind = self.resolved(kind)
        if kind in ("float", "double"):
            return 4 if kind == "float" else 8
        if kind[0] == "int":
            return max(1, kind[1] // 8)
        if kind[0] == "pointer":
            return 8
        if kind[0] == "array":
            return kind[1] * self.size(kind[2])
        if kind[0] == "struct":
            ends = [at + self.size(member) for at, member in self.members(kind)]
            most = self.align(kind)
            return -(-ends[-1] // most) * most if ends else 0
        raise Unsupported(f"the size of {kind}")

    @remembered
    def members(self, kind):
        """The members of a struct as (byte, type)."""
        at, found = 0, []
        for member in kind[1]:
            align = self.align(member)
            at = -(-at // align) * align
            found.append((at, member))
            at += self.size(member)
        return found

    @remembered
    def sort(self, kind):
        """The sort of the values of a type."""
        kind = self.resolved(kind)
        if kind in ("float", "double"):
            return "f32" if kind == "float" else "f64"
        if kind[0] == "int":
            return "b" if kind[1] == 1 else integers(kind[1])
        if kind[0] == "pointer":
            return integers(64)
        if kind[0] == "array": # <2 x float> in which clang passes a struct
            return integers(8 * self.size(kind))
        raise Unsupported(f"a value of {kind}")


class Function(Machine):
    """A function of a module. hooks: name to a function that stands for a callee.
    item: of the first loop that the function has itself only the iteration with this
    counter is executed; the iterations must not depend on each other."""

    def __init__(self, module, name, memory, hooks=None, item=None):
        super().__init__(memory)
        self.item, self.loop = item, None
        if name not in module.functions:
            raise Unsupported("no function " + name)
        self.module, self.name, self.hooks = module, name, hooks or {}
        self.params, self.blocks, self.follow = [], {}, {}
        if ("function", name) not in module.memo:
            self.read(*module.functions[name])
            module.memo["function", name] = (self.params, self.blocks, self.follow,
                                             postdominators(self.follow))
        self.params, self.blocks, self.follow, self.meets = module.memo["function", name]

    def read(self, params, body):
        """Splits the parameters, and the body into blocks of (place, statement)."""
        for param in split(params):
            if param != "...":
                kind, _ = self.module.parse(param)
                register = re.search(r"(%[\w.\-]+)$", param)[1]
                self.params.append((register, kind, "byval(" in param))
        block, place = None, None
        for line in body.split("\n"):
            note = re.search(r", !dbg !(\d+)", line)
            place = self.module.place(note[1]) if note else place
            line = re.sub(r", !\w+[^,]*|\s*;.*$|, !.*$", "", line).strip()
            label = re.match(r"([\w.\-]+):", line)
            if label:
                block = label[1]
                self.blocks[block] = []
            elif line and block is not None and self.blocks[block] and (
                    self.blocks[block][-1][1].startswith("switch")):
                self.blocks[block][-1] = place, self.blocks[block][-1][1] + " " + line
            elif line:
                block = block or "entry"
                self.blocks.setdefault(block, []).append((place, line))
        for name, lines in self.blocks.items():
            last = lines[-1][1]
            self.follow[name] = re.findall(r"label %([\w.\-]+)", last) or [EXIT]

    def call(self, state, args):
        """Executes the function in the caller's memory; returns its value."""
        caller, state.regs = (state.regs, state.result), {}
        state.result = None
        for (register, kind, by_value), arg in zip(self.params, args):
            if by_value:
                own = self.memory.fresh(self.name + register)
                self.memory.copy(state, own, arg, self.module.size(kind[1]))
                arg = own
            state.regs[register] = arg
        ended = self.run(next(iter(self.blocks)), state)
        result = ended.result
        state.memory, state.known = ended.memory, ended.known
        state.regs, state.result = caller
        return result

    def value(self, state, kind, text):
        """An operand of a type."""
        text = text.strip()
        if text.startswith("%"):
            return state.regs[text]
        kind = self.module.resolved(kind)
        if text in ("undef", "poison"):
            if kind[0] == "struct":
                return tuple(self.value(state, k, text) for k in kind[1])
            return leaf("undefined", self.module.sort(kind))
        if text in ("true", "false"):
            return truth(text == "true")
        if text in ("null", "zeroinitializer"):
            return words.const(8 * self.module.size(kind), 0)
        if kind in ("float", "double"):
            sort = self.module.sort(kind)
            if text.startswith("0x"):
                return floats.convert(floats.of_bits("f64", int(text, 16)), sort)
            return floats.const(sort, float(text))
        if kind[0] == "int" and re.match(r"-?\d+$", text):
            return truth(int(text)) if kind[1] == 1 else words.const(
                kind[1], int(text))
        if text.startswith("@"):
            return self.variable(state, text[1:])
        inner = re.match(r"bitcast \((.*) to .*\)$", text)
        if inner:
            kind, end = self.module.parse(inner[1])
            return self.value(state, kind, inner[1][end:])
        inner = re.match(r"getelementptr inbounds \((.*)\)$", text)
        if inner:
            return self.element(state, split(inner[1]))
        raise Unsupported("operand " + text)

    def variable(self, state, name):
        """The address of a variable or a function. What a variable begins with is
        taken as its value: those of ref/ are constant."""
        at = leaf(("variable", name), integers(64))
        text = self.module.globals.get(name)
        if text and at not in self.memory.filled:
            first = State()
            first.regs = state.regs
            self.memory.locals.add(at)
            kind, end = self.module.parse(text)
            self.fill(first, at, kind, text[end:].strip())
            self.memory.filled[at] = first.memory.get(at, {})
        return at

    def fill(self, state, at, kind, text):
        """Writes the initial value of a variable."""
        plain = self.module.resolved(kind)
        if text.startswith("zeroinitializer"):
            for k in range(self.module.size(kind)):
                self.memory.store(state, words.add(at, words.const(64, k)),
                                  words.const(8, 0))
            return
        if plain[0] not in ("array", "struct"):
            self.put(state, kind, at, self.value(state, kind, text))
            return
        if text.startswith('c"'):
            for k, (code, letter) in enumerate(re.findall(
                    r"\\([0-9A-F]{2})|([^\\])", text[2:-1])):
                self.memory.store(state, words.add(at, words.const(64, k)),
                                  words.const(8, int(code, 16) if code else
                                              ord(letter)))
            return
        first, last = "[]" if plain[0] == "array" else "{}"
        members = split(text[text.index(first) + 1:text.rindex(last)])
        for k, member in enumerate(members):
            inner, end = self.module.parse(member)
            byte = (k * self.module.size(inner) if plain[0] == "array"
                    else self.module.members(plain)[k][0])
            self.fill(state, words.add(at, words.const(64, byte)), inner,
                      member[end:].strip())

    def element(self, state, parts):
        """getelementptr"""
        kind, _ = self.module.parse(parts[0])
        pointer, end = self.module.parse(parts[1])
        at = self.value(state, pointer, parts[1][end:])
        for k, part in enumerate(parts[2:]):
            index, end = self.module.parse(part)
            n = self.value(state, index, part[end:])
            if k:
                plain = self.module.resolved(kind)
                if plain[0] == "struct":
                    byte, kind = self.module.members(plain)[n.args[0]]
                    at = words.add(at, words.const(64, byte))
                    continue
                kind = plain[2]
            step = words.const(64, self.module.size(kind))
            at = words.add(at, words.mul(words.extend_signed(n, 64), step))
        return at

    def edge(self, source, to, state):
        """Sets what phi statements choose by the block that ran before."""
        new = {}
        for _, line in self.blocks.get(to, ()):
            found = re.match(r"(%[\w.\-]+) = phi (.*)$", line)
            if not found:
                break
            kind, end = self.module.parse(found[2])
            for text, block in re.findall(r"\[ (.*?), %([\w.\-]+) \]", found[2][end:]):
                if block == source:
                    new[found[1]] = self.value(state, kind, text)
        state.regs.update(new)

    def get(self, state, kind, at):
        """A value of a type from memory."""
        plain = self.module.resolved(kind)
        if plain[0] == "struct":
            return tuple(self.get(state, member, words.add(at, words.const(64, byte)))
                         for byte, member in self.module.members(plain))
        sort = self.module.sort(kind)
        found = self.memory.load(state, at, self.module.size(kind))
        if sort == "b":
            return negate(words.compare("eq", found, words.const(8, 0)))
        return floats.number(found, sort) if is_float(sort) else found

    def put(self, state, kind, at, new):
        """Writes a value of a type."""
        if isinstance(new, tuple):
            members = self.module.members(self.module.resolved(kind))
            for (byte, member), part in zip(members, new):
                self.put(state, member, words.add(at, words.const(64, byte)), part)
            return
        if new.sort == "b":
            new = words.extend(new, 8)
        self.memory.store(state, at, floats.bits(new) if is_float(new.sort) else new)

    def begin_item(self, name, state):
        """At the head of the loop: sets the counter, which the loop loads first. Where
        the item has ended, returns the blocks that follow."""
        if self.loop == name:
            return self.follow[name][1:]
        if self.loop is None:
            self.loop = name
            kind, at = split(self.blocks[name][0][1].partition(" = load ")[2])[:2]
            kind, _ = self.module.parse(kind)
            self.put(state, kind, self.operand(state, at),
                     words.cut(self.item, 0, self.module.sort(kind)[1]))
        return None

    def block(self, name, state):
        """Executes the block; returns its condition and successors."""
        if self.item is not None and re.match(r"for\.cond\d*$", name):
            ended = self.begin_item(name, state)
            if ended:
                return TRUE, ended
        for place, line in self.blocks[name]:
            target, word, args = taken_apart(line)
            if word == "phi":
                continue
            if word == "br":
                found = re.match(r"i1 (\S+), label", args)
                if not found:
                    return TRUE, self.follow[name]
                return self.value(state, ("int", 1), found[1]), self.follow[name]
            if word == "ret":
                if args != "void":
                    kind, end = self.module.parse(args)
                    state.result = self.value(state, kind, args[end:])
                return TRUE, [EXIT]
            before = len(TABLE.terms)
            result = self.statement(state, word, args)
            TABLE.origin.update((k, place) for k in range(before, len(TABLE.terms)))
            if target:
                state.regs[target] = result
        raise Unsupported("how a block ends: " + self.blocks[name][-1][1])

    def operand(self, state, text):
        """A type and an operand in one text."""
        return self.value(state, *self.module.operand(text))

    def pair(self, state, text):
        """One type and two operands."""
        kind, end = self.module.parse(text)
        return [self.value(state, kind, part) for part in split(text[end:])]

    def statement(self, state, word, text):
        """Executes one instruction; returns its value."""
        if word == "alloca":
            return self.memory.fresh(f"{self.name}.{len(state.regs)}")
        if word == "load":
            kind, _ = self.module.parse(text)
            return self.get(state, kind, self.operand(state, split(text)[1]))
        if word == "store":
            source, to = split(text)[:2]
            kind, _ = self.module.parse(source)
            self.put(state, kind, self.operand(state, to), self.operand(state, source))
            return None
        if word == "getelementptr":
            return self.element(state, split(text.replace("inbounds ", "", 1)))
        if word in CASTS:
            return self.cast(state, word, *text.rsplit(" to ", 1))
        if word in FLOAT:
            return FLOAT[word](*self.pair(state, text))
        if word == "fneg":
            return floats.neg(self.operand(state, text))
        if word == "fcmp":
            name, rest = text.split(" ", 1)
            return floats.relation(RELATION[name], *self.pair(state, rest))
        if word == "icmp":
            name, rest = text.split(" ", 1)
            a, b = (words.extend(x, 8) if x.sort == "b" else x
                    for x in self.pair(state, rest))
            return words.relation(name[-2:], a, b, name[0] == "s")
        if word == "select":
            return merge_values(*(self.operand(state, part) for part in split(text)))
        if word in WHOLE or word in ("srem", "sdiv", "urem", "udiv"):
            return self.whole(state, word, text)
        if word == "extractvalue":
            found = re.match(r".* (%[\w.]+), (\d+)$", text)
            return state.regs[found[1]][int(found[2])]
        if word == "insertvalue":
            whole, part, at = split(text)
            held = list(self.operand(state, whole))
            held[int(at)] = self.operand(state, part)
            return tuple(held)
        if word == "call":
            return self.invoke(state, text)
        raise Unsupported(f"{word} {text}")

    def whole(self, state, word, text):
        """An operation on two integers or conditions."""
        text = re.sub(r"^(?:(?:nuw|nsw|exact) )+", "", text)
        a, b = self.pair(state, text)
        if a.sort == "b":
            return TRUTH[word](a, b)
        if word in WHOLE:
            return WHOLE[word](a, b)
        return words.divide(word, a, b)

    def cast(self, state, word, source, to):
        """A conversion."""
        a, sort = self.operand(state, source), self.module.sort(
            self.module.parse(to)[0])
        if word in ("fpext", "fptrunc"):
            return floats.convert(a, sort)
        if word in ("zext", "sext"):
            return widen(state, a, sort[1], word == "sext")
        if word == "trunc" and sort == "b":
            bits = a.sort[1] if a.sort[1] == 8 else 1 # a bool is 0 or 1
            return words.relation("ne", words.cut(a, 0, bits), words.const(bits, 0),
                                  False)
        if word == "trunc":
            return words.cut(a, 0, sort[1])
        if word in ("sitofp", "uitofp"):
            a = words.extend(a, 32) if a.sort == "b" else a
            return floats.of_int(a, sort, word[0] == "s")
        if word in ("fptosi", "fptoui"):
            return floats.to_int(a, sort[1], word == "fptosi")
        if is_float(a.sort) and isinstance(sort, tuple):
            return floats.bits(a)
        if is_float(sort) and isinstance(a.sort, tuple):
            return floats.number(a, sort)
        return a

    def invoke(self, state, text):
        """A call."""
        found = re.search(r"@([\w.]+)\((.*)\)[^)]*$", text)
        if not found:
            raise Unsupported("call " + text)
        name = found[1]
        if name.startswith(("llvm.lifetime", "llvm.dbg", "llvm.assume")):
            return None
        args = [self.operand(state, part) for part in split(found[2])]
        if name.startswith(("llvm.memcpy", "llvm.memmove")):
            if not words.is_const(args[2]):
                raise Unsupported(name)
            self.memory.copy(state, args[0], args[1], args[2].args[0])
            return None
        if name.startswith("llvm.memset"):
            for k in range(args[2].args[0]):
                at = words.add(args[0], words.const(64, k))
                self.memory.store(state, at, args[1])
            return None
        if name in ("memcmp", "bcmp"): # only whether all is equal
            size = args[2].args[0]
            same = both(*(words.compare("eq", *(self.memory.load(
                state, words.add(arg, words.const(64, k)), 4) for arg in args[:2]))
                          for k in range(0, size, 4)))
            return words.extend(negate(same), 32)
        short = re.sub(r"^llvm\.(\w+)\..*", r"\1", name)
        if short in CALLS:
            return CALLS[short](args[0])
        if name in self.hooks:
            return self.hooks[name](self, state, args)
        item, module = self.hooks.get("item of " + name), self.module
        if name not in module.functions:
            module = next((m for m in module.linked if name in m.functions), module)
        return Function(module, name, self.memory, self.hooks, item).call(
            state, args)


def execute(module, name, memory, args, state=None, hooks=None):
    """Executes a function; returns its value and the state that it leaves. hooks:
    also "item of NAME" to the counter of the one iteration of the loop in NAME."""
    state = state or State()
    return Function(module, name, memory, hooks).call(state, args), state
