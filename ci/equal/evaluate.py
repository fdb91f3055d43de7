# SPDX-License-Identifier: Apache-2.0
"""The value of terms for given inputs: conditions are True or False, integers the
number of their bits, and numbers Python's floats."""
import operator
import random

import exact
from term import Unsupported, bits_of, float_of, signed

MASK = {bits: (1 << bits) - 1 for bits in range(1, 129)}


def divided(op, x, y, bits):
    """A quotient or remainder as LLVM names it; of 0 it is 0."""
    if y == 0:
        return 0
    if op[0] == "s":
        x, y = signed(x, bits), signed(y, bits)
    quotient = abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1)
    return (quotient if op[1:] == "div" else x - quotient * y) & MASK[bits]


def shifted(op, x, n, bits):
    """x shifted by n as PTX shifts, which knows shifts by the width and more."""
    if op == "shl":
        return x << n & MASK[bits] if n < bits else 0
    return (x if op == "lshr" else signed(x, bits)) >> min(n, 128) & MASK[bits]


INTEGERS = {"and_bits": operator.and_, "or_bits": operator.or_,
            "xor_bits": operator.xor, "eq": operator.eq, "ult": operator.lt}
NUMBERS = {"<": operator.lt, "<=": operator.le, "==": operator.eq, "neg": operator.neg,
           "abs": abs, "min": exact.least, "max": exact.most}
ROUNDED = {"+": exact.add, "*": exact.mul, "/": exact.div, "sqrt": exact.root,
           "fma": exact.fma}


def apply(term, v):
    """The value of a term whose operands have the values v."""
    op, args, sort = term.op, term.args, term.sort
    inner = args[0].sort if args and hasattr(args[0], "sort") else None
    bits = sort[1] if isinstance(sort, tuple) else 0
    if op in NUMBERS:
        return NUMBERS[op](*v)
    if op in ROUNDED:
        return ROUNDED[op](sort, *v)
    if op in INTEGERS:
        return INTEGERS[op](*v)
    if op == "choice":
        return v[1] if v[0] else v[2]
    if op in ("true", "false"):
        return op == "true"
    if op == "not":
        return not v[0]
    if op == "and":
        return all(v)
    if op == "float":
        return float_of(sort, args[0])
    if op == "int":
        return args[0]
    if op == "sum":
        return (sum(x * n for x, (_, n) in zip(v, args[0])) + args[1]) & MASK[bits]
    if op == "times":
        return v[0] * v[1] & MASK[bits]
    if op == "bits":
        return bits_of(inner, v[0])
    if op == "number":
        return float_of(sort, v[0])
    if op == "cut":
        return v[0] >> args[1] & MASK[bits]
    if op == "joined":
        return v[0] << args[1].sort[1] | v[1]
    if op == "extend":
        return v[0]
    if op == "extend_signed":
        return signed(v[0], inner[1]) & MASK[bits]
    if op in ("shl", "lshr", "ashr"):
        return shifted(op, v[0], v[1], bits)
    if op in ("sdiv", "srem", "udiv", "urem"):
        return divided(op, v[0], v[1], bits)
    if op == "slt":
        return signed(v[0], inner[1]) < signed(v[1], inner[1])
    if op == "convert":
        return exact.rounded(sort, v[0])
    if op == "of_signed":
        return exact.rounded(sort, float(signed(v[0], inner[1])))
    if op == "of_unsigned":
        return exact.rounded(sort, float(v[0]))
    if op in ("to_signed", "to_unsigned"):
        return exact.whole(v[0], bits, op == "to_signed")
    if op.startswith("call "): # what an unknown predicate finds
        return random.Random(repr((op, v))).random() < 1 / 3
    raise Unsupported("a value of " + op)


def values(terms, inputs):
    """The values of terms, which are in order; inputs: leaf to value."""
    known = {}
    for term in terms:
        if term.op == "leaf":
            known[term.id] = inputs(term)
        elif term.op == "sum":
            known[term.id] = apply(term, [known[k.id] for k, _ in term.args[0]])
        else:
            known[term.id] = apply(term, [known[k.id] for k in term.args
                                          if hasattr(k, "id")])
    return known

