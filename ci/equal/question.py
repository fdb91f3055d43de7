# SPDX-License-Identifier: Apache-2.0
"""What a row of ci/equal/twins.def asks: pairs of terms that must be equal."""
import functools
import re

import floats
import llvm
import ptx
import table
import together
import words
from logic import choose
from run import Memory, State, assume
from term import FALSE, TRUE, Unsupported, integers, is_float, leaf, make, width

SCALARS = {"int": 32, "int32_t": 32, "uint32_t": 32, "int64_t": 64, "uint64_t": 64,
           "unsigned": 32}
ITEM = ("%ctaid.x", "%ntid.x", "%tid.x")
ERRORS = ("bad", "words") # parameters of kernels that only tell of bad input


@functools.cache
def parsed(path, kind):
    """A compiled file, parsed once."""
    with open(path, encoding="utf-8") as file:
        return kind(file.read())


def argument(kind, name, bits):
    """What a parameter of a wrapper holds, for the device and for the reference."""
    if "*" in kind:
        both = leaf(name, integers(64))
        return both, both
    if kind == "bool":
        both = leaf(("argument", name), "b")
        return words.extend(both, 8), both
    if kind in ("real", "double", "float"):
        sort = f"f{bits}" if kind == "real" else "f64" if kind == "double" else "f32"
        both = floats.number(leaf(("argument", name), integers(width(sort))), sort)
        return both, both
    both = leaf(("argument", name), integers(SCALARS[kind]))
    return both, both


def kernel_arguments(twin, module, memory, function, state):
    """The same of a kernel, whose arguments are one struct in memory, and the item. The
    struct holds the first argument and a struct of the others (gpu/run/kernel.cuh)."""
    base, at, held = leaf("args", integers(64)), 0, []
    params = llvm.Function(module, function, memory).params
    kinds = [kind.startswith("struct ") and "*" not in kind for kind, _ in twin.params]
    types = [of[1] if by else of for by, (_, of, _) in zip(kinds, params)]
    for k, (by_reference, inner) in enumerate(zip(kinds, types)):
        align = max(map(module.align, types[k:]))
        at = -(-at // align) * align
        there = words.add(base, words.const(64, at))
        at += module.size(inner)
        if by_reference:
            held.append(there)
            continue
        found = memory.load(state, there, module.size(inner))
        sort = module.sort(inner)
        if sort == "b":
            found = words.relation("ne", found, words.const(8, 0), False)
        held.append(floats.number(found, sort) if is_float(sort) else found)
    block, size, thread = (words.extend(leaf(name, integers(32)), 64) for name in ITEM)
    held.append(thread if twin.coordinates
                else words.add(words.mul(block, size), thread))
    return [ptx.Base(base)], held


def hole(name, skipped):
    """A callee of which nothing is known but that it returns a sign, which depends on
    its operands."""
    def called(machine, state, args):
        del machine, state
        args = [a[0] if isinstance(a, dict) else a for a in args]
        seen = () if skipped < 0 else tuple(args[skipped:])
        below, above = (make(f"call {name} {sign} 0", seen, "b") for sign in "<>")
        positive = words.extend(above, 32)
        return choose(below, words.const(32, -1), positive)
    return called


def fixed(memory, state, given):
    """Writes what a precondition says an input is, so that loops see it."""
    for part in given.args if given.op == "and" else (given,):
        if part.op != "eq":
            continue
        a, b = part.args if words.is_const(part.args[1]) else part.args[::-1]
        byte = a.args[1] // 8 if a.op == "cut" else 0
        a = a.args[1] if a.op == "joined" else a.args[0] if a.op == "cut" else a
        if words.is_const(b) and a.op == "leaf" and a.args[0][0] == "memory":
            _, name, first = a.args[0]
            at = words.add(memory.bases[name], words.const(64, first + byte))
            memory.store(state, at, b)


def is_number(term):
    """Whether an integer in memory is the bits of a number."""
    return term.op == "bits" or (term.op == "choice" and any(
        map(is_number, term.args[1:])))


def is_undefined(term):
    """Whether a value is what local memory has before anything is written."""
    return term.op == "leaf" and term.args[0][0] == "nothing"


def cells(memory, ref, device, private):
    """What either side has left in memory that is neither local nor private, as pairs
    of terms. What the reference leaves undefined, as padding, is not compared."""
    pairs = []
    for base in {**ref.memory, **device.memory}:
        if base in memory.locals or base in private:
            continue
        ours, theirs = ref.memory.get(base, {}), device.memory.get(base, {})
        written, done = sorted(ours.keys() | theirs.keys()), None
        for byte in written:
            if done is not None and byte < done:
                continue
            count = size_at(ours if byte in ours else theirs, byte)
            at = words.add(base, words.const(64, byte))
            pair = [memory.load(side, at, count) for side in (ref, device)]
            if any(map(is_number, pair)):
                sort = {4: "f32", 8: "f64"}[count]
                pair = [floats.number(x, sort) for x in pair]
            if not is_undefined(pair[0]):
                pairs.append(tuple(pair))
            done = byte + count
    return pairs


def size_at(side, byte):
    """The bytes of what begins at a byte: of a copy of two words the first."""
    term, low = side[byte]
    bits = term.sort[1] - 8 * low
    if low == 0 and term.op == "joined":
        bits = term.args[1].sort[1]
    return bits // 8


def mangled(word):
    """The pattern of a template's argument in the name of a kernel: a number, or a type,
    which may be of a precision and of a file."""
    if word.isdigit():
        return f"Li{word}E"
    return rf"(?:N\d+_GLOBAL__N_\w*?)?(?:{len(word)}{word}|{len(word) + 3}{word}_\d\d)E?"


def entry_of(file, twin):
    """The name in PTX of a kernel for one world."""
    plain, of = re.match(r"(\w+)(?:<([\w ]+)>)?", twin.device).groups()
    inner = "".join(map(mangled, (of or "").split()))
    part = re.compile(rf"{len(plain)}{plain}" + (f"I{inner}E" if of else ""))
    names = [n for n in file.functions if "one_kernel" in n and part.search(n)
             and "merged_kernel" not in n]
    if len(names) != 1:
        raise Unsupported(f"{len(names)} kernels of this name")
    return names[0]


def result(memory, count, stream, bits):
    """A callee that returns the next of a stream of reals; count: where their number is."""
    def called(machine, state, args):
        del machine, args
        n = memory.load(state, count, 4)
        memory.store(state, count, words.add(n, words.const(32, 1)))
        by = words.mul(words.extend(n, 64), words.const(64, bits // 8))
        found = memory.load(state, words.add(stream, by), bits // 8)
        return floats.number(found, f"f{bits}")
    return called


def hooks_of(twin, bits, item, memory, state):
    """What stands for functions of the reference."""
    group, hooks = twin.group, {}
    for ref, stream in group.results.items():
        count = memory.fresh("calls of " + ref)
        memory.store(state, count, words.const(32, 0))
        for end in ("", f"_{bits}"):
            hooks[ref + end] = result(memory, count, leaf(stream, integers(64)), bits)
    for end in ("", f"_{bits}"):
        for ref, n in group.holes.values():
            hooks[ref + end] = hole(ref, min(n, 0))
        for ref, value in group.valid.items():
            found = {"true": TRUE, "false": FALSE}.get(value)
            found = found or words.const(32, int(value))
            hooks[ref + end] = lambda *_, found=found: found
        if twin.each:
            hooks[f"item of {re.search(r'([a-z_0-9]+)[(]', twin.ref)[1]}{end}"] = item
    return hooks


def threads_of(twin):
    """The threads that are executed: any, or the three of the item %tid.x."""
    if twin.shape:
        return []
    if not twin.coordinates:
        return [{}]
    block, _, thread = ITEM
    item = leaf(thread, integers(32))
    return [{block: words.const(32, 0),
             thread: words.add(words.mul(item, words.const(32, 3)), words.const(32, c))}
            for c in range(3)]


def condition(twin, module, memory, args, state, hooks):
    """The condition of a row in this state."""
    truth, _ = llvm.execute(module, f"given_{twin.name}", memory, args, state.copy(),
                            hooks)
    return words.relation("ne", truth, words.const(32, 0), False)


def loose_file(text):
    """A PTX file in which sums and products without .rn have a meaning."""
    return ptx.File(text, True)


def device_file(build, twin, bits, again):
    """The PTX of a row, by the build's flags or by others (versions.py)."""
    if again:
        name = re.sub(r"\.cu$", "", twin.group.device) if twin.kernel else twin.group.name
        return parsed(f"{build}/equal/again/{name}.{bits}.ptx", loose_file)
    if twin.kernel:
        path = re.sub(r"\.cu$", f".{bits}.ptx", twin.group.device)
        return parsed(f"{build}/ptx/{path}", ptx.File)
    return parsed(f"{build}/equal/{twin.group.name}.{bits}.ptx", ptx.File)


def device_state(file, twin, memory, params, start):
    """What a file's device side of a row leaves."""
    name = entry_of(file, twin) if twin.kernel else f"twin_{twin.name}"
    hooks = {device: hole(ref_name, skipped)
             for device, (ref_name, skipped) in twin.group.holes.items()}
    state = start.copy()
    if twin.shape:
        state = together.execute(file, name, memory, params, state, hooks, twin.shape)
    for threads in threads_of(twin):
        state = ptx.execute(file, name, memory, params, state, hooks, threads)
    return state


def question(build, twin, bits, again=False, machine=None):
    """Pairs of terms that must be equal, and the condition under which. again: of the
    device's side and the same by other flags, not of the reference and the device.
    machine: of memory and a state what stands for the device's side (sass.py)."""
    group, memory = twin.group, Memory()
    module = parsed(f"{build}/equal/{group.name}.{bits}.ll", llvm.Module)
    names = map(table.link_name, group.linked)
    module.linked = [parsed(f"{build}/equal/{name}.{bits}.ll", llvm.Module)
                     for name in names]
    for other in module.linked:
        other.linked = [module, *module.linked]
    function, start = f"twin_{twin.name}", State()
    if twin.kernel:
        params, args = kernel_arguments(twin, module, memory, function, start)
    else:
        params, args = zip(*(argument(kind, n, bits) for kind, n in twin.params))
    given, args = TRUE, list(args)
    hooks = hooks_of(twin, bits, args[-1], memory, start)
    if twin.given:
        whole = condition(twin, module, memory, args, start, hooks)
        fixed(memory, start, whole)
        if twin.kernel: # what is fixed is no input
            params, args = kernel_arguments(twin, module, memory, function, start)
        given = condition(twin, module, memory, args, start, hooks)
        for known in (whole, given):
            assume(start, known, True)
    if again:
        file = device_file(build, twin, bits, True)
        ref = device_state(file, twin, memory, params, start)
    else:
        _, ref = llvm.execute(module, function, memory, args, start.copy(), hooks)
    if machine:
        device = machine(memory, start)
    else:
        file = device_file(build, twin, bits, False)
        device = device_state(file, twin, memory, params, start)
    private = [arg for (_, n), arg in zip(twin.params, args)
               if twin.kernel and n in ERRORS]
    return cells(memory, ref, device, private), given
