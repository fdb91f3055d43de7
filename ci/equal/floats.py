# SPDX-License-Identifier: Apache-2.0
"""Terms of floating-point numbers.

+ × ÷ √ are IEEE 754's, rounded to nearest, and nothing else is known of them. Their
laws that are used hold for every input, one NaN taken for another:
  a - b = a + (-b); a + b = b + a; a · b = b · a; (-a) · b = -(a · b), so of ÷;
  1 · a = a; 2 · a = a + a; a / 2^k = a · 2^-k where that is exact; a + (-0) = a.
Where a is not -0, a + 0 = a, and the sign of b's zero does not show in a + b.
Not used, as they are false at zeros: a + 0 = a; (-a) + (-b) = -(a + b); a - a = 0.
"""
import math

import exact
import words
from logic import both, choose, either, negate, push, truth
from term import TABLE, WIDTH, bits_of, float_of, integers, make


def of_bits(sort, number):
    """The constant with these bits."""
    return make("float", (number,), sort)


def const(sort, x):
    """The constant x, rounded."""
    return of_bits(sort, bits_of(sort, x))


def is_const(a):
    """Whether a term is a constant number."""
    return a.op == "float"


def value(a):
    """The value of a constant."""
    return float_of(a.sort, a.args[0])


def neg(a):
    """-a"""
    if is_const(a):
        return of_bits(a.sort, a.args[0] ^ 1 << (WIDTH[a.sort] - 1))
    return a.args[0] if a.op == "neg" else make("neg", (a,), a.sort)


def size(a):
    """|a|"""
    if is_const(a):
        return of_bits(a.sort, a.args[0] & ~(1 << (WIDTH[a.sort] - 1)))
    if a.op == "abs":
        return a
    return size(a.args[0]) if a.op == "neg" else make("abs", (a,), a.sort)


def in_order(op, a, b):
    """A commutative operation, its operands in a fixed order."""
    return make(op, (a, b) if a.id <= b.id else (b, a), a.sort)


def is_minus_zero(a):
    """Whether a is the constant -0."""
    return is_const(a) and a.args[0] == 1 << (WIDTH[a.sort] - 1)


def is_zero(a):
    """Whether a term is the constant +0."""
    return a.op == "float" and a.args[0] == 0


def never_minus_zero(a):
    """Whether a number cannot be -0, by its shape: only a sum of two -0 is -0, and no
    square is."""
    memo = TABLE.memos["never -0"]
    if a.id not in memo:
        memo[a.id] = (a.op == "abs" or (is_const(a) and not is_minus_zero(a))
                      or (a.op == "*" and a.args[0] is a.args[1])
                      or (a.op == "sqrt" and never_minus_zero(a.args[0]))
                      or (a.op == "+" and any(map(never_minus_zero, a.args))))
    return memo[a.id]


def add(a, b):
    """a + b"""
    if is_const(a) and is_const(b):
        return const(a.sort, exact.add(a.sort, value(a), value(b)))
    if is_minus_zero(a):
        return b
    if is_minus_zero(b):
        return a
    if is_zero(b) and never_minus_zero(a):
        return a
    if is_zero(a) and never_minus_zero(b):
        return b
    if TABLE.zeros and never_minus_zero(a):
        b = unsigned(b)
    elif TABLE.zeros and never_minus_zero(b):
        a = unsigned(a)
    if TABLE.zeros and is_const(a) and value(a) != 0:
        b = unsigned(b)
    elif TABLE.zeros and is_const(b) and value(b) != 0:
        a = unsigned(a)
    return in_order("+", a, b)


def sub(a, b):
    """a - b"""
    return add(a, neg(b))


def mul(a, b):
    """a · b"""
    if is_const(a) and is_const(b):
        return const(a.sort, exact.mul(a.sort, value(a), value(b)))
    if is_const(b):
        a, b = b, a
    if is_const(a):
        if abs(value(a)) == 1:
            return b if value(a) == 1 else neg(b)
        if value(a) == 2:
            return add(b, b)
        if math.copysign(1, value(a)) < 0 and value(a) == value(a):
            return neg(mul(neg(a), b))
    if a.op == "neg":
        return neg(mul(a.args[0], b))
    if b.op == "neg":
        return neg(mul(a, b.args[0]))
    return in_order("*", a, b)


def div(a, b):
    """a / b"""
    if is_const(a) and is_const(b):
        return const(a.sort, exact.div(a.sort, value(a), value(b)))
    if is_const(b) and math.isfinite(value(b)):
        part, power = math.frexp(value(b))
        if abs(part) == 0.5 and abs(power) < 100:
            return mul(const(b.sort, 1 / value(b)), a)
    if a.op == "neg":
        return neg(div(a.args[0], b))
    if b.op == "neg":
        return neg(div(a, b.args[0]))
    if is_const(a) and math.copysign(1, value(a)) < 0:
        return neg(div(neg(a), b))
    return make("/", (a, b), a.sort)


def root(a):
    """√a"""
    if is_const(a):
        return const(a.sort, exact.root(a.sort, value(a)))
    return make("sqrt", (a,), a.sort)


def fma(a, b, c):
    """a · b + c, rounded once, which the number model does not have: nothing is known
    of it but its value for known numbers."""
    a, b = (a, b) if a.id <= b.id else (b, a)
    return make("fma", (a, b, c), a.sort)


def least(a, b):
    """PTX's min, which orders -0 below +0 and returns the other operand for a NaN. Of
    a constant but +0 it is a < b ? a : b."""
    if is_const(a):
        a, b = b, a
    if is_const(b) and b.args[0] and value(b) == value(b):
        return choose(less(a, b), a, b)
    return in_order("min", a, b)


def most(a, b):
    """PTX's max; of a constant but -0 it is a > b ? a : b."""
    if is_const(a):
        a, b = b, a
    if is_const(b) and not is_minus_zero(b) and value(b) == value(b):
        return choose(less(b, a), a, b)
    return in_order("max", a, b)


def convert(a, sort):
    """a, rounded to the other sort of numbers."""
    if a.sort == sort:
        return a
    if is_const(a):
        return const(sort, value(a))
    if a.op == "neg":
        return neg(convert(a.args[0], sort))
    if a.op == "choice":
        return push(lambda x: convert(x, sort), ("convert", sort), a)
    if a.op == "convert" and sort == a.args[0].sort == "f32":
        return a.args[0]
    return make("convert", (a,), sort)


def bits(a):
    """The bits of a number, as an integer."""
    if is_const(a):
        return words.const(WIDTH[a.sort], a.args[0])
    if a.op == "number":
        return a.args[0]
    return make("bits", (a,), integers(WIDTH[a.sort]))


def number(a, sort):
    """The number that has these bits."""
    if words.is_const(a):
        return of_bits(sort, a.args[0])
    if a.op == "bits" and a.args[0].sort == sort:
        return a.args[0]
    if a.op == "choice":
        return choose(a.args[0], number(a.args[1], sort), number(a.args[2], sort))
    if a.op == "joined" and a.args[0].op == a.args[1].op == "choice":
        (condition, *high), (other, *low) = (part.args for part in a.args)
        if condition is other:
            return choose(condition, *(number(words.join(x, y), sort)
                                       for x, y in zip(high, low)))
    return make("number", (a,), sort)


def of_int(a, sort, with_sign=True):
    """An integer, rounded to a number."""
    if words.is_const(a):
        whole = words.value(a) if with_sign else a.args[0]
        if abs(whole) <= 2**53:
            return const(sort, float(whole))
    if words.is_flag(a):
        return push(lambda x: of_int(x, sort, with_sign), ("of", sort, with_sign), a)
    return make("of_signed" if with_sign else "of_unsigned", (a,), sort)


def to_int(a, bits_wide, with_sign=True):
    """A number, cut to an integer; nothing is known of one that is out of range."""
    return make("to_signed" if with_sign else "to_unsigned", (a,),
                integers(bits_wide))


def unsigned(a):
    """a but for the sign of a zero, in a form that depends less on how a was
    written; for comparisons, and for sums with a constant that is not 0."""
    memo = TABLE.memos["unsigned"]
    if a.id not in memo:
        memo[a.id] = unsigned_of(a)
    return memo[a.id]


def unsigned_of(a):
    """The same, without a memory."""
    if a.op == "float":
        return const(a.sort, 0.0) if value(a) == 0 else a
    if a.op in ("neg", "abs", "convert", "*", "sqrt"):
        inner = [unsigned(x) for x in a.args]
        return {"neg": neg, "abs": size, "*": mul, "sqrt": root,
                "convert": lambda x: convert(x, a.sort)}[a.op](*inner)
    if a.op == "/":
        below = unsigned(a.args[1])
        known = never_minus_zero(below) and never_minus_zero(a.args[1])
        return div(unsigned(a.args[0]), below if known else a.args[1])
    if a.op == "+":
        x, y = sorted((unsigned(k) for k in a.args), key=lambda k: key_of(k).id)
        return neg(add(neg(x), neg(y))) if x.op == "neg" else add(x, y)
    if a.op == "choice":
        return unsigned_choice(*a.args)
    return a


def unsigned_choice(condition, x, y):
    """A choice but for the sign of a zero: of a number and its negative it is the
    size."""
    if x.op != "neg" and y is neg(x):
        if condition is less(y, x):
            return size(x)
        if condition is less(x, const(x.sort, 0.0)):
            return neg(size(x))
    x, y = unsigned(x), unsigned(y)
    if x.op == "neg":
        return neg(choose(condition, neg(x), unsigned(neg(y))))
    return choose(condition, x, y)


def key_of(a):
    """a without its sign."""
    return a.args[0] if a.op == "neg" else a


def has_const(a):
    """Whether a choice has a constant among its values."""
    return is_const(a) or (a.op == "choice" and any(map(has_const, a.args[1:])))


def narrowed(op, a, b):
    """A comparison of numbers that were binary32, in binary32; else None."""
    if a.op == b.op == "convert" and a.args[0].sort == b.args[0].sort == "f32":
        return compare(op, a.args[0], b.args[0])
    if a.sort == "f64" and a.op == "convert" and is_const(b):
        if exact.rounded("f32", value(b)) == value(b):
            return compare(op, a.args[0], const("f32", value(b)))
    if a.sort == "f64" and b.op == "convert" and is_const(a):
        if exact.rounded("f32", value(a)) == value(a):
            return compare(op, const("f32", value(a)), b.args[0])
    return None


def of_difference(op, a, b):
    """0 < x + y is -x < y, as a sum is 0 only where it is exactly 0; else None."""
    if TABLE.zeros and op == "<":
        if is_const(a) and value(a) == 0 and b.op == "+":
            return less(neg(b.args[0]), b.args[1])
        if is_const(b) and value(b) == 0 and a.op == "+":
            return less(a.args[0], neg(a.args[1]))
    return None


def of_choice(op, a, b):
    """A comparison of a choice with a constant as a choice; else None."""
    if is_const(a) and b.op == "choice" and (TABLE.zeros or has_const(b)):
        return push(lambda x: compare(op, a, x), (op, "right", a.id), b)
    if is_const(b) and a.op == "choice" and (TABLE.zeros or has_const(a)):
        return push(lambda x: compare(op, x, b), (op, "left", b.id), a)
    return None


def compare(op, a, b):
    """a op b, of < <= ==; false where an operand is NaN."""
    if is_const(a) and is_const(b):
        x, y = value(a), value(b)
        return truth({"<": x < y, "<=": x <= y, "==": x == y}[op])
    if TABLE.zeros:
        a, b = unsigned(a), unsigned(b)
    found = narrowed(op, a, b) or of_difference(op, a, b) or of_choice(op, a, b)
    if found:
        return found
    signs = [x.op == "neg" or is_const(x) for x in (a, b)]
    if all(signs):
        a, b = neg(b), neg(a)
    a, b = (const(x.sort, 0.0) if is_const(x) and value(x) == 0 else x
            for x in (a, b))
    if a is b:
        if op == "<":
            return truth(False)
        op = "=="
    if op == "==" and a.id > b.id:
        a, b = b, a
    return make(op, (a, b), "b")


def less(a, b):
    """a < b"""
    return compare("<", a, b)


def at_most(a, b):
    """a <= b"""
    return compare("<=", a, b)


def same(a, b):
    """a == b"""
    return compare("==", a, b)


def ordered(a, b):
    """Whether neither is NaN."""
    return both(same(a, a), same(b, b))


def relation(name, a, b):
    """A comparison by PTX's name; with a `u` it is true where an operand is NaN."""
    unequal = either(less(a, b), less(b, a))
    plain = {"lt": lambda: less(a, b), "le": lambda: at_most(a, b),
             "gt": lambda: less(b, a), "ge": lambda: at_most(b, a),
             "eq": lambda: same(a, b), "ne": lambda: unequal,
             "num": lambda: ordered(a, b), "nan": lambda: negate(ordered(a, b)),
             "ltu": lambda: negate(at_most(b, a)), "leu": lambda: negate(less(b, a)),
             "gtu": lambda: negate(at_most(a, b)), "geu": lambda: negate(less(a, b)),
             "equ": lambda: negate(unequal), "neu": lambda: negate(same(a, b))}
    return plain[name]()
