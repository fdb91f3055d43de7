# SPDX-License-Identifier: Apache-2.0
"""Terms of integers. Sums are kept as coefficients of terms and a constant, so that
addresses that are the same are one term.

Assumed: what is widened with its sign did not overflow, as C leaves that undefined.
"""
import functools
import operator

import floats
from logic import choose, negate, of_constants, push, truth
from term import FALSE, TABLE, Term, integers, make, signed


def const(width, number):
    """An integer constant."""
    return make("int", (number & ((1 << width) - 1),), integers(width))


def is_const(a):
    """Whether a term is an integer constant."""
    return a.op == "int"


def value(a):
    """A constant as a signed number."""
    return signed(a.args[0], a.sort[1])


def is_flag(a):
    """Whether a term is a choice of two constants."""
    return a.op == "choice" and is_const(a.args[1]) and is_const(a.args[2])


def parts(a):
    """A sum as a dictionary of coefficients and a constant."""
    if is_const(a):
        return {}, a.args[0]
    return (dict(a.args[0]), a.args[1]) if a.op == "sum" else ({a: 1}, 0)


def total(width, of, constant):
    """The sum with these coefficients and this constant."""
    mask = (1 << width) - 1
    of = {term: factor & mask for term, factor in of.items() if factor & mask}
    constant &= mask
    if not of:
        return const(width, constant)
    if constant == 0 and list(of.values()) == [1]:
        return next(iter(of))
    items = tuple(sorted(of.items(), key=lambda item: item[0].id))
    key = ("sum", width, constant, tuple((term.id, factor) for term, factor in items))
    if key not in TABLE.terms:
        TABLE.terms[key] = Term("sum", (items, constant), integers(width),
                                len(TABLE.terms))
    return TABLE.terms[key]


def add(a, b, times=1):
    """a + times · b"""
    of, constant = parts(a)
    more, other = parts(b)
    for term, factor in more.items():
        of[term] = of.get(term, 0) + times * factor
    return total(a.sort[1], of, constant + times * other)


def sub(a, b):
    """a - b"""
    return add(a, b, -1)


def mul(a, b):
    """a · b"""
    if is_const(a):
        a, b = b, a
    if is_const(b):
        of, constant = parts(a)
        factor = b.args[0]
        return total(a.sort[1], {term: n * factor for term, n in of.items()},
                     constant * factor)
    return distributed(a, b) or in_order("times", a, b)


def distributed(a, b):
    """The product of sums as the sum of products; None of two that are no sums."""
    (of, plus), (more, other) = parts(a), parts(b)
    if (a.op != "sum" and b.op != "sum") or len(of) * len(more) > 16:
        return None
    made = {}
    for x, n in of.items():
        for y, m in more.items():
            product = in_order("times", x, y)
            made[product] = made.get(product, 0) + n * m
    for terms, factor in ((of, other), (more, plus)):
        for term, n in terms.items():
            made[term] = made.get(term, 0) + n * factor
    return total(a.sort[1], made, plus * other)


def in_order(op, a, b):
    """A commutative operation, its operands in a fixed order."""
    return make(op, (a, b) if a.id <= b.id else (b, a), a.sort)


def divide(op, a, b):
    """The quotient or the remainder, cut towards 0; op as LLVM names it."""
    if is_const(a) and is_const(b) and b.args[0]:
        with_sign = op[0] == "s"
        x, y = (value(a), value(b)) if with_sign else (a.args[0], b.args[0])
        quotient = abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1)
        return const(a.sort[1], quotient if op[1:] == "div" else x - quotient * y)
    if is_const(b) and b.args[0] and b.args[0] & (b.args[0] - 1) == 0 and op[0] == "s":
        return by_power(op, a, b.args[0].bit_length() - 1)
    found = of_constants(lambda x, y: divide(op, x, y), a, b)
    return found or make(op, (a, b), a.sort)


def by_power(op, a, n):
    """The quotient or the remainder of a and 2^n, by shifts."""
    width, power = a.sort[1], const(a.sort[1], 1 << n)
    if n == 0:
        return a if op[1:] == "div" else const(width, 0)
    sign = a if n == 1 else shift_signed(a, const(width, width - 1))
    moved = add(a, extend(cut(sign, width - n, n), width))
    quotient = shift_signed(moved, const(width, n))
    return quotient if op[1:] == "div" else sub(a, mul(quotient, power))


def shift_left(a, b):
    """a · 2^b; 0 where b is the width or more."""
    width = a.sort[1]
    if is_const(b):
        n = b.args[0]
        return mul(a, const(width, 1 << n)) if n < width else const(width, 0)
    return make("shl", (a, b), a.sort)


def shift_right(a, b):
    """a / 2^b of an integer without a sign."""
    width = a.sort[1]
    if is_const(b):
        n = b.args[0]
        if n >= width:
            return const(width, 0)
        return extend(cut(a, n, width - n), width) if n else a
    return make("lshr", (a, b), a.sort)


def shift_signed(a, b):
    """a / 2^b of an integer with a sign, rounded down."""
    if is_const(a) and is_const(b):
        return const(a.sort[1], value(a) >> min(b.args[0], 63))
    if is_const(b) and b.args[0] == 0:
        return a
    found = of_constants(shift_signed, a, b)
    if is_const(b):
        found = found or shift_back(a, b.args[0])
    return found or make("ashr", (a, b), a.sort)


def shift_back(a, n):
    """a / 2^n of a sum that is a multiple of 2^zeros, n ≤ zeros: its other bits,
    widened with their sign; else None."""
    width = a.sort[1]
    of, constant = parts(a)
    low = constant | functools.reduce(operator.or_, of.values(), 0)
    zeros = (low & -low).bit_length() - 1
    if not of or n > zeros:
        return None
    inner = total(width, {term: factor >> zeros for term, factor in of.items()},
                  constant >> zeros)
    wide = extend_signed(cut(inner, 0, width - zeros), width)
    return shift_left(wide, const(width, zeros - n))


def conjunction(a, b):
    """The bits that both have."""
    if is_const(a) and is_const(b):
        return const(a.sort[1], a.args[0] & b.args[0])
    if is_const(a):
        a, b = b, a
    if a is b:
        return a
    if is_const(b):
        found = masked(a, b.args[0], a.sort[1])
        if found:
            return found
    return of_constants(conjunction, a, b) or in_order("and_bits", a, b)


def masked(a, mask, width):
    """a & mask, where that is a part of a, its size, or a itself; else None."""
    ones = mask.bit_length()
    if mask == 0:
        return const(width, 0)
    if a.op == "bits" and mask == (1 << (width - 1)) - 1:
        return floats.bits(floats.size(a.args[0]))
    if mask == (1 << ones) - 1:
        return extend(cut(a, 0, ones), width)
    low = (mask & -mask).bit_length() - 1
    if mask == (1 << width) - (1 << low):
        power = const(width, low)
        return shift_left(shift_signed(a, power), power)
    return None


def disjunction(a, b):
    """The bits that either has."""
    if is_const(a) and is_const(b):
        return const(a.sort[1], a.args[0] | b.args[0])
    if is_const(a):
        a, b = b, a
    if a is b or (is_const(b) and b.args[0] == 0):
        return a
    found = side_by_side(a, b) or side_by_side(b, a)
    if found:
        return found
    return of_constants(disjunction, a, b) or in_order("or_bits", a, b)


def side_by_side(a, b):
    """a | b where a has bits in front of those of b only; else None."""
    of, constant = parts(a)
    if len(of) != 1 or constant or b.op != "extend":
        return None
    (high, factor), = of.items()
    n = factor.bit_length() - 1
    if factor != 1 << n or high.op != "extend" or b.args[0].sort[1] > n:
        return None
    return join(cut(high, 0, a.sort[1] - n), extend(b.args[0], n))


def insert(a, b, low, count):
    """b, in which so many bits from `low` on are the lowest of a; constants."""
    whole, end = b.sort[1], low + count
    result = join(cut(a, 0, count), cut(b, 0, low)) if low else cut(a, 0, count)
    return join(cut(b, end, whole - end), result) if end < whole else result


def difference(a, b):
    """The bits that one of both has."""
    width = a.sort[1]
    if is_const(a) and is_const(b):
        return const(width, a.args[0] ^ b.args[0])
    if is_const(a):
        a, b = b, a
    if a is b:
        return const(width, 0)
    if is_const(b):
        if b.args[0] == 0:
            return a
        if b.args[0] == (1 << width) - 1: # ~a = -1 - a
            return sub(b, a)
        if a.op == "bits" and b.args[0] == 1 << (width - 1):
            return floats.bits(floats.neg(a.args[0]))
    return of_constants(difference, a, b) or in_order("xor_bits", a, b)


def is_thread(a):
    """Whether an integer is a thread's number, which is below 2^31."""
    return a.op == "leaf" and str(a.args[0]).startswith("%")


def is_item(a):
    """Whether a sum is a thread's item, which is below 2^31 as well."""
    of, constant = parts(a)
    return all(map(is_thread, of)) and max(of.values()) < 8 and constant < 8


def extend(a, width):
    """a with zeros in front; of a condition 0 or 1."""
    if a.sort == "b":
        return choose(a, const(width, 1), const(width, 0))
    if a.sort[1] == width:
        return a
    if is_const(a):
        return const(width, a.args[0])
    if is_flag(a):
        return push(lambda x: extend(x, width), ("extend", width), a)
    if a.op == "extend":
        return extend(a.args[0], width)
    if is_thread(a) or (a.op == "sum" and is_item(a)):
        return extend_signed(a, width)
    if a.op == "cut" and is_thread(a.args[0]) and a.args[1] == 0 and a.sort[1] > 30:
        return extend_signed(a.args[0], width)
    return make("extend", (a,), integers(width))


def extend_signed(a, width):
    """a with copies of its sign in front."""
    if a.sort == "b":
        return choose(a, const(width, -1), const(width, 0))
    if a.sort[1] == width:
        return a
    if is_const(a):
        return const(width, value(a))
    if a.op == "choice":
        return push(lambda x: extend_signed(x, width), ("signed", width), a)
    if a.op == "extend":
        return extend(a.args[0], width)
    if a.op == "times":
        return mul(*(extend_signed(x, width) for x in a.args))
    if a.op == "sum":
        bits, wide, constant = a.sort[1], {}, signed(a.args[1], a.sort[1])
        for term, factor in parts(a)[0].items():
            inner, more = parts(extend_signed(term, width))
            for key, times in inner.items():
                wide[key] = wide.get(key, 0) + signed(factor, bits) * times
            constant += signed(factor, bits) * more
        return total(width, wide, constant)
    return make("extend_signed", (a,), integers(width))


def cut(a, low, width):
    """So many bits of a, from bit `low` on."""
    whole = a.sort[1]
    if low == 0 and width == whole:
        return a
    if is_const(a):
        return const(width, a.args[0] >> low)
    if a.op == "joined":
        high, rest = a.args
        if low >= rest.sort[1]:
            return cut(high, low - rest.sort[1], width)
        if low + width <= rest.sort[1]:
            return cut(rest, low, width)
    if a.op == "ashr" and is_const(a.args[1]):
        by = a.args[1].args[0]
        if low + width + by <= whole:
            return cut(a.args[0], low + by, width)
    if a.op in ("extend", "extend_signed"):
        inner = a.args[0]
        if low + width <= inner.sort[1]:
            return cut(inner, low, width)
        if a.op == "extend":
            if low >= inner.sort[1]:
                return const(width, 0)
            return extend(cut(inner, low, inner.sort[1] - low), width)
        if low == 0:
            return extend_signed(inner, width)
    if a.op == "cut":
        return cut(a.args[0], low + a.args[1], width)
    if a.op == "sum":
        found = high_of_sum(a, low, width) if low else cut_sum(a, width)
        if found:
            return found
    if a.op == "times" and low == 0:
        return mul(*(cut(x, 0, width) for x in a.args))
    if a.op == "bits" and a.args[0].op == "choice":
        return push(lambda x: cut(floats.bits(x), low, width), ("cut bits", low, width),
                    a.args[0])
    if a.op == "choice":
        return push(lambda x: cut(x, low, width), ("cut", low, width), a)
    return make("cut", (a, low), integers(width))


def cut_sum(a, width):
    """The lower bits of a sum as a sum of lower bits."""
    of, constant = parts(a)
    low = {}
    for term, factor in of.items():
        inner, more = parts(cut(term, 0, width))
        for inner_term, inner_factor in inner.items():
            low[inner_term] = low.get(inner_term, 0) + inner_factor * factor
        constant += more * factor
    return total(width, low, constant)


def high_of_sum(a, low, width):
    """The bits from `low` on of a sum of threads' numbers, which are below 2^31, where
    its parts below 2^low do not carry; else None."""
    of, constant = parts(a)
    if not all(is_thread(term.args[0] if term.op.startswith("extend") else term)
               for term in of):
        return None
    rest = sum((factor & ((1 << low) - 1)) << 31 for factor in of.values())
    if rest + (constant & ((1 << low) - 1)) >= 1 << low:
        return None
    wide = a.sort[1]
    return cut(total(wide, {term: factor >> low for term, factor in of.items()},
                     constant >> low), 0, width)


def permuted(a, selector):
    """Four bytes of a, one by each of the selector's four digits."""
    result = None
    for k in range(4):
        digit = selector >> 4 * k & 15
        piece = cut(a, 8 * (digit & 7), 8)
        if digit & 8:
            piece = cut(extend_signed(cut(piece, 7, 1), 8), 0, 8)
        result = piece if result is None else join(piece, result)
    return result


def in_parts(a, b):
    """Two integers as pairs of parts, of which one is joined so and the other one, too,
    or constant; else None."""
    if a.op != "joined" and b.op != "joined":
        return None
    low = (a if a.op == "joined" else b).args[1].sort[1]
    sides = []
    for x in (a, b):
        if not is_const(x) and (x.op != "joined" or x.args[1].sort[1] != low):
            return None
        sides.append((cut(x, low, x.sort[1] - low), cut(x, 0, low)))
    return list(zip(*sides))


def size(a):
    """a without its sign."""
    zero = const(a.sort[1], 0)
    return choose(compare("slt", a, zero), sub(zero, a), a)


def is_choice_of_constants(a):
    """Whether all values of a choice of choices are constants."""
    return is_const(a) or (a.op == "choice" and
                           all(map(is_choice_of_constants, a.args[1:])))


def join(high, low):
    """The bits of both in a row."""
    width, below = high.sort[1] + low.sort[1], low.sort[1]
    if is_const(high) and is_const(low):
        return const(width, high.args[0] << below | low.args[0])
    if is_const(high) and high.args[0] == 0:
        return extend(low, width)
    if high.op == "cut":
        whole, at = high.args
        if low.op == "cut" and low.args[0] is whole and at == low.args[1] + below:
            return cut(whole, low.args[1], width)
        if at == below and high.sort[1] + at == whole.sort[1] and cut(
                whole, 0, at) is low:
            return whole
    if high.op == low.op == "choice" and high.args[0] is low.args[0]:
        sides = [join(high.args[k], low.args[k]) for k in (1, 2)]
        if all(side.op != "joined" for side in sides):
            return choose(high.args[0], *sides)
    if low.op == "choice" and is_const(high) and is_choice_of_constants(low):
        return choose(low.args[0], join(high, low.args[1]), join(high, low.args[2]))
    if high.op == "choice" and is_const(low) and is_choice_of_constants(high):
        return choose(high.args[0], join(high.args[1], low), join(high.args[2], low))
    return sign_changed(high, low) or make("joined", (high, low), integers(width))


def sign_changed(high, low):
    """The double of which only the half with the sign was changed; else None."""
    if low.op != "cut" or low.args[1] or low.sort[1] + high.sort[1] != 64:
        return None
    whole = low.args[0]
    if whole.op != "bits":
        return None
    for change in (floats.neg, floats.size):
        other = floats.bits(change(whole.args[0]))
        if cut(other, low.sort[1], high.sort[1]) is high:
            return other
    return None


def compare(op, a, b):
    """a op b; op: eq, slt, sle, ult, ule, as LLVM names them."""
    if is_const(a) and is_const(b):
        x, y = (value(a), value(b)) if op[0] == "s" else (a.args[0], b.args[0])
        return truth({"eq": x == y, "lt": x < y, "le": x <= y}[op[-2:]])
    if a is b:
        return truth(op in ("eq", "sle", "ule"))
    found = of_constants(lambda x, y: compare(op, x, y), a, b)
    if found is not None:
        return found
    if op == "eq":
        return equal(a, b)
    if op[1:] == "le":
        return negate(compare(op[0] + "lt", b, a))
    narrow = narrowed(a, b) if op == "slt" else None
    if narrow:
        return compare(op, *narrow)
    if op == "slt" and is_const(b):
        if a.op == "extend" and value(b) <= 0:
            return FALSE
        if a.op == "choice" and any(map(is_const, a.args[1:])):
            return push(lambda x: compare(op, x, b), ("slt", b.id), a)
    if op == "slt" and is_const(a) and value(a) != (1 << (a.sort[1] - 1)) - 1:
        return negate(compare("slt", b, const(a.sort[1], value(a) + 1)))
    if op == "ult" and is_const(b) and b.args[0] == 1:
        return compare("eq", a, const(a.sort[1], 0))
    if op == "ult" and is_const(a) and a.args[0] == 0:
        return negate(compare("eq", a, b))
    return make(op, (a, b), "b")


def narrowed(a, b):
    """Two integers that were widened with their signs before they were; else None."""
    inner = [x.args[0] if x.op == "extend_signed" else None for x in (a, b)]
    for k, other in ((0, b), (1, a)):
        if inner[k] is not None and is_const(other):
            narrow = const(inner[k].sort[1], other.args[0])
            if extend_signed(narrow, other.sort[1]) is other:
                return (inner[0], narrow) if k == 0 else (narrow, inner[1])
    if inner[0] is not None and inner[1] is not None and (
            inner[0].sort == inner[1].sort):
        return tuple(inner)
    return None


def equal(a, b):
    """a == b of terms that are not both constants."""
    of, constant = parts(sub(a, b))
    if not of:
        return truth(constant == 0)
    if is_const(a):
        a, b = b, a
    if is_const(b) and b.args[0] == 0 and a.op == "and_bits":
        x, mask = a.args if is_const(a.args[1]) else a.args[::-1]
        if is_const(mask) and mask.args[0] & (mask.args[0] - 1) == 0: # of one bit
            bit = cut(x, mask.args[0].bit_length() - 1, 1)
            return compare("eq", bit, const(1, 0))
    if is_const(b) and a.op in ("extend", "extend_signed"):
        inner = a.args[0]
        narrow = const(inner.sort[1], b.args[0])
        wide = extend if a.op == "extend" else extend_signed
        if wide(narrow, a.sort[1]) is not b:
            return FALSE
        return compare("eq", inner, narrow)
    if a.sort == b.sort and a.op == b.op and a.op in ("extend", "extend_signed"):
        if a.args[0].sort == b.args[0].sort:
            return compare("eq", a.args[0], b.args[0])
    return in_order_b("eq", a, b)


def in_order_b(op, a, b):
    """A commutative relation, its operands in a fixed order."""
    return make(op, (a, b) if a.id <= b.id else (b, a), "b")


def relation(name, a, b, with_sign):
    """A comparison by PTX's name."""
    kind = "s" if with_sign else "u"
    return {"eq": lambda: compare("eq", a, b),
            "ne": lambda: negate(compare("eq", a, b)),
            "lt": lambda: compare(kind + "lt", a, b),
            "le": lambda: compare(kind + "le", a, b),
            "gt": lambda: compare(kind + "lt", b, a),
            "ge": lambda: compare(kind + "le", b, a),
            "lo": lambda: compare("ult", a, b), "ls": lambda: compare("ule", a, b),
            "hi": lambda: compare("ult", b, a), "hs": lambda: compare("ule", b, a),
            }[name]()
