# SPDX-License-Identifier: Apache-2.0
"""Symbolic execution: what a program leaves in memory, as terms of its inputs.

Where a condition is undecided, both sides run up to the block where they meet, the
immediate postdominator of the branch, and their registers and bytes are merged by
choices. So there are no paths to count, and loops unroll as far as their conditions
are decided.

Memory is by base, the part of an address that is not constant, and byte. Assumed:
two bases do not overlap.
"""
import words
from logic import both, choose, negate
from term import FALSE, TABLE, TRUE, Term, Unsupported, integers, leaf, order, show, signed

EXIT = "<exit>"
MOST_STEPS, MOST_DEPTH = 60000, 400


class Bytes(dict):
    """base → byte → cell (Memory). Copies share the cells of a base until one of them
    writes there; `own` has the bases whose cells are in no other."""

    def __init__(self, other=()):
        super().__init__(other)
        self.own = set()

    def copy(self):
        self.own.clear()
        return Bytes(self)

    def cells(self, base):
        """The cells of a base, to be written."""
        if base not in self.own:
            self[base] = dict(self.get(base, {}))
            self.own.add(base)
        return self[base]


class State:
    """Registers, memory, the value returned, and what the path has decided:
    condition's number to truth."""

    def __init__(self):
        self.regs, self.memory, self.result, self.known = {}, Bytes(), None, {}

    def copy(self):
        """The same, to go on from apart."""
        other = State()
        other.regs, other.known = dict(self.regs), dict(self.known)
        other.memory = self.memory.copy()
        other.result = self.result
        return other


def merge_values(condition, a, b):
    """condition ? a : b of values or of aggregates of them."""
    if a is b or b is None:
        return a
    if a is None:
        return b
    if isinstance(a, dict):
        return {k: merge_values(condition, a.get(k), b.get(k))
                for k in {**a, **b}}
    if isinstance(a, tuple):
        return tuple(merge_values(condition, x, y) for x, y in zip(a, b))
    if a.sort != b.sort:
        return a # a register that is used for another type: nobody reads it
    return choose(condition, a, b)


class Memory:
    """base → byte → (integer term, number of its byte). A byte that nobody has
    written is an input, or in local memory has no value. filled: what variables begin
    with."""

    def __init__(self):
        self.count, self.locals, self.bases, self.filled = 0, set(), {}, {}

    def fresh(self, name):
        """The base of new local memory."""
        self.count += 1
        base = leaf(("local", name, self.count), integers(64))
        self.locals.add(base)
        return base

    @staticmethod
    def split(address):
        """Base and byte of an address."""
        memo = TABLE.memos["base and byte"]
        if address.id not in memo:
            memo[address.id] = Memory.split_new(address)
        return memo[address.id]

    @staticmethod
    def split_new(address):
        """The same of an address that is met for the first time."""
        of, constant = words.parts(address)
        for term in of:
            if any(inner.op in ("joined", "choice") and
                   any(k.op != "leaf" for k in inner.args)
                   for inner in order([term])):
                raise Unsupported("an address like " + show(address, 3))
        return words.total(64, of, 0), signed(constant, 64)

    def initial(self, base, byte):
        """What a byte that nobody has written has."""
        if byte in self.filled.get(base, ()):
            return self.filled[base][byte]
        if base in self.locals:
            return leaf(("nothing", base.id, byte), integers(8)), 0
        word = byte & ~3
        name = base.args[0] if base.op == "leaf" and isinstance(
            base.args[0], str) else f"at{base.id}"
        self.bases[name] = base
        return leaf(("memory", name, word), integers(32)), byte - word

    def cases(self, address):
        """An address that depends on conditions as [(condition, address)]."""
        for term, factor in words.parts(address)[0].items():
            inner, extend = term, None
            if term.op in ("extend", "extend_signed"):
                inner = term.args[0]
                extend = (words.extend if term.op == "extend"
                          else words.extend_signed)
            if inner.op == "choice":
                condition, *sides = inner.args
                rest = words.sub(address, words.mul(term, words.const(64, factor)))
                found = []
                for side, when in zip(sides, (condition, negate(condition))):
                    side = extend(side, 64) if extend else side
                    there = words.add(rest, words.mul(side, words.const(64, factor)))
                    found += [(both(when, c), a) for c, a in self.cases(there)]
                return [(c, a) for c, a in found if c is not FALSE]
        return [(TRUE, address)]

    def load(self, state, address, count):
        """So many bytes as an integer."""
        result = None
        for condition, at in reversed(self.cases(address)):
            loaded = self.load_at(state, at, count)
            result = loaded if result is None else choose(condition, loaded, result)
        return result

    def load_at(self, state, address, count):
        """The same of an address without conditions."""
        base, first = self.split(address)
        cells = state.memory.get(base, {})
        found = [cells.get(first + k) or self.initial(base, first + k)
                 for k in range(count)]
        result, k = None, 0
        while k < count:
            term, low = found[k]
            n = 1
            while k + n < count and found[k + n] == (term, low + n):
                n += 1
            piece = words.cut(term, 8 * low, 8 * n)
            result = piece if result is None else words.join(piece, result)
            k += n
        return result

    def store(self, state, address, term):
        """Writes an integer of whole bytes, of joined parts each by itself."""
        if term.op == "joined" and term.args[1].sort[1] % 8 == 0:
            high, low = term.args
            self.store(state, address, low)
            self.store(state, words.add(address, words.const(64, low.sort[1] // 8)),
                       high)
            return
        count = term.sort[1] // 8
        for condition, at in self.cases(address):
            base, first = self.split(at)
            new = choose(condition, term, self.load_at(state, at, count)
                         ) if condition is not TRUE else term
            state.memory.cells(base).update({first + k: (new, k) for k in range(count)})

    def copy(self, state, to, source, count):
        """Copies so many bytes, each with the term that it is of."""
        froms, tos = self.cases(source), self.cases(to)
        if len(froms) > 1 or len(tos) > 1:
            pieces = [self.load(state, words.add(source, words.const(64, k)), 4)
                      for k in range(0, count, 4)]
            for k, piece in enumerate(pieces):
                self.store(state, words.add(to, words.const(64, 4 * k)), piece)
            return
        base, first = self.split(froms[0][1])
        cells = state.memory.get(base, {})
        found = [cells.get(first + k) or self.initial(base, first + k)
                 for k in range(count)]
        base, first = self.split(tos[0][1])
        state.memory.cells(base).update((first + k, cell) for k, cell in enumerate(found))

    def merge_base(self, condition, base, a, b):
        """The bytes of two paths, in pieces as long as the longer of both sides'."""
        ours, theirs = a.memory.get(base, {}), b.memory.get(base, {})
        merged, done = {**ours, **theirs}, set()
        for byte in sorted(k for k in merged if ours.get(k) != theirs.get(k)):
            if byte in done:
                continue
            cells = [cell for cell in (ours.get(byte), theirs.get(byte)) if cell]
            count = max(cell[0].sort[1] // 8 - cell[1] for cell in cells)
            at = words.add(base, words.const(64, byte))
            term = choose(condition, *(self.load_at(state, at, count)
                                       for state in (a, b)))
            merged.update((byte + k, (term, k)) for k in range(count))
            done.update(range(byte, byte + count))
        return merged

    def merge(self, condition, a, b):
        """The state where two paths meet."""
        state = State()
        for register in {**a.regs, **b.regs}:
            state.regs[register] = merge_values(
                condition, a.regs.get(register), b.regs.get(register))
        state.memory = Bytes({**a.memory, **b.memory})
        for base in [base for base in state.memory
                     if a.memory.get(base) is not b.memory.get(base)]:
            state.memory[base] = self.merge_base(condition, base, a, b)
            state.memory.own.add(base)
        state.result = merge_values(condition, a.result, b.result)
        state.known = {k: v for k, v in a.known.items() if b.known.get(k) == v}
        return state


def postdominators(follow):
    """Block → its immediate postdominator; follow: block → successors."""
    after = {block: set(follow) | {EXIT} for block in follow}
    after[EXIT] = {EXIT}
    changed = True
    while changed:
        changed = False
        for block in reversed(list(follow)):
            new = set.intersection(*(after[n] for n in follow[block])) | {block}
            changed = changed or new != after[block]
            after[block] = new
    return {block: max(after[block] - {block}, key=lambda n: len(after[n]),
                       default=EXIT) for block in follow}


def decide(state, condition):
    """What a path has decided about a condition, or None."""
    if condition is TRUE or condition is FALSE:
        return condition is TRUE
    if condition.id in state.known:
        return state.known[condition.id]
    if condition.op == "not":
        inner = decide(state, condition.args[0])
        return None if inner is None else not inner
    if condition.op == "and":
        of = [decide(state, part) for part in condition.args]
        return False if False in of else None if None in of else True
    return None


def assume(state, condition, truth):
    """Notes that a condition is true or false on a path."""
    if condition.op == "not":
        assume(state, condition.args[0], not truth)
        return
    state.known[condition.id] = truth
    if condition.op == "and" and truth:
        for part in condition.args:
            assume(state, part, True)


def widen(state, a, width, with_sign):
    """An integer in more bits. One that the path knows not to be negative is widened
    with its sign, whichever way the compiler took."""
    below = words.compare("slt", a, words.const(a.sort[1], 0)) if (
        a.sort != "b") else TRUE
    if with_sign or decide(state, below) is False:
        return words.extend_signed(a, width)
    return words.extend(a, width)


def settle(state):
    """Decides choices in registers by what the path has decided."""
    for register, value in state.regs.items():
        while isinstance(value, Term) and value.op == "choice":
            known = decide(state, value.args[0])
            if known is None:
                break
            value = state.regs[register] = value.args[1 if known else 2]


class Machine:
    """A function to execute. A front end sets blocks and follow, and defines
    block(name, state), which executes a block and returns its condition and
    successors, and edge(from, to, state). apart: the blocks before
    which threads wait for each other (together.py)."""

    def __init__(self, memory):
        self.memory, self.steps, self.meets, self.apart = memory, 0, {}, set()

    def block(self, name, state):
        """Executes a block; returns (condition, successors)."""
        raise NotImplementedError

    def edge(self, source, to, state):
        """What happens between two blocks."""

    def run(self, block, state, stop=EXIT, depth=0):
        """Executes from a block on until `stop`."""
        if depth > MOST_DEPTH:
            raise Unsupported("a loop without a bound")
        while block not in (stop, EXIT):
            self.steps += 1
            if self.steps > MOST_STEPS:
                raise Unsupported("more than so many steps")
            if block in self.apart:
                raise Unsupported("threads meet on one side of a branch")
            block, state = self.advance(block, state, depth)
        return state

    def advance(self, block, state, depth=0):
        """Executes a block and what follows it up to the block where undecided paths
        meet; returns the next block and the state."""
        condition, targets = self.block(block, state)
        known = decide(state, condition)
        if known is None:
            return self.fork(block, state, condition, targets, depth)
        target = targets[0 if known else 1]
        self.edge(block, target, state)
        return target, state

    def fork(self, block, state, condition, targets, depth):
        """Executes both sides of a branch; returns where they meet, and the state."""
        meet, sides = self.meets[block], [state.copy(), state]
        for k, (side, target) in enumerate(zip(sides, targets)):
            assume(side, condition, k == 0)
            settle(side)
            self.edge(block, target, side)
            sides[k] = self.run(target, side, meet, depth + 1)
        return meet, self.memory.merge(condition, *sides)
