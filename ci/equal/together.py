# SPDX-License-Identifier: Apache-2.0
"""The threads of a launch of fixed size, executed together: each up to where threads
meet, a barrier or an exchange between lanes of a warp, then all on from there.

Between two meetings the threads run one after another. Their order does not matter
where there is no race, which ci/models/ shows. Blocks run one after another, each with
shared memory of its own. A meeting on one side of a branch that is not decided stops
the proof.
"""
import re

import ptx
import words
from run import EXIT, State
from term import Unsupported, integers

WARP = 32
SHUFFLE = re.compile(r"shfl\.sync\.(\w+)\.b32 (%\w+)(?:\|\S+)?, (%\w+), (\S+), (\S+), \S+$")


class Thread:
    """A thread: its number in the block, where it is, and its registers."""

    def __init__(self, number, state, numbers, space):
        self.number, self.at, self.state = number, "entry", state
        self.numbers, self.space = numbers, space


class Block:
    """The threads of a block."""

    def __init__(self, function, start, shape, number):
        (blocks, count), shared, self.function = shape, {}, function
        self.threads = []
        for k in range(count):
            numbers = {"%tid.x": k, "%ctaid.x": number, "%ntid.x": count,
                       "%nctaid.x": blocks, "%laneid": k % WARP}
            for name in ("%tid", "%ctaid"):
                numbers.update({f"{name}.{axis}": 0 for axis in "yz"})
            numbers = {name: words.const(32, n) for name, n in numbers.items()}
            self.threads.append(Thread(k, start.copy(), numbers, self.space(shared)))

    def space(self, shared):
        """The variables of a thread: its own, and those that it shares."""
        memory, found = self.function.memory, {}
        of_file = [("shared", name) for name in self.function.file.shared]
        for kind, name in [*of_file, *self.function.variables]:
            if kind == "local" or name not in shared:
                found[name] = memory.fresh(name)
                if kind == "shared":
                    shared[name] = found[name]
            found[name] = found[name] if kind == "local" else shared[name]
        return found

    def go(self, thread, bytes_):
        """Executes a thread up to the next meeting; returns memory as it is then."""
        function, state, first = self.function, thread.state, True
        function.threads, function.space = thread.numbers, thread.space
        state.memory, function.steps = bytes_, 0
        while thread.at != EXIT and (first or thread.at not in function.apart):
            first = False
            thread.at, state = function.advance(thread.at, state)
        thread.state = state
        return state.memory

    def statement(self, thread):
        """The statement at which a thread waits."""
        return self.function.blocks[thread.at][0][1]

    def exchange(self, lanes):
        """Gives each lane of a warp that waits at a shuffle the value that it asks
        for. A lane without a source keeps its own."""
        found = SHUFFLE.match(self.statement(lanes[0]))
        if not found:
            raise Unsupported(self.statement(lanes[0]))
        mode, _, source, by, width = found.groups()
        held, self.function.threads = {}, lanes[0].numbers
        width = self.function.value(lanes[0].state, width, integers(32))
        if width is not words.const(32, 0 if mode == "up" else WARP - 1):
            raise Unsupported("shfl within parts of a warp")
        for lane in lanes:
            held[lane.number % WARP] = lane.state.regs[source]
        for lane in lanes:
            n = self.function.value(lane.state, by, integers(32))
            if not words.is_const(n):
                raise Unsupported("shfl from a lane that is not fixed")
            own, n = lane.number % WARP, n.args[0]
            n = {"up": own - n, "down": own + n, "idx": n, "bfly": own ^ n}[mode]
            lane.state.regs["from another lane"] = held.get(n, held[own])

    def run(self, bytes_):
        """Executes all threads; returns memory as they leave it."""
        warps = [self.threads[k:k + WARP] for k in range(0, len(self.threads), WARP)]
        while self.threads:
            for warp in warps:
                bytes_ = self.run_warp(warp, bytes_)
            self.threads = [t for t in self.threads if t.at != EXIT]
        return bytes_

    def run_warp(self, warp, bytes_):
        """Executes a warp up to a barrier."""
        lanes = [t for t in warp if t.at != EXIT]
        while lanes:
            for lane in lanes:
                bytes_ = self.go(lane, bytes_)
            lanes = [t for t in lanes if t.at != EXIT]
            if not lanes or all(not self.statement(t).startswith("shfl") for t in lanes):
                break
            if len({t.at for t in lanes}) != 1:
                raise Unsupported("lanes of a warp meet at several places")
            self.exchange(lanes)
        return bytes_


def execute(file, name, memory, params, state, hooks, shape):
    """Executes a kernel in a launch of (blocks, threads); returns the state that it
    leaves."""
    function = ptx.Function(file, name, memory, params, hooks, None, True)
    left = state.copy()
    for number in range(shape[0]):
        start = State()
        start.known = dict(state.known)
        left.memory = Block(function, start, shape, number).run(left.memory)
    return left
