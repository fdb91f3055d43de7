# SPDX-License-Identifier: Apache-2.0
"""Conditions, and choices by conditions."""
import floats
import words
from term import FALSE, TABLE, TRUE, WIDTH, is_float, make


def truth(value):
    """The condition that is always true or false."""
    return TRUE if value else FALSE


def negate(a):
    """not a"""
    if a is TRUE or a is FALSE:
        return truth(a is FALSE)
    return a.args[0] if a.op == "not" else make("not", (a,), "b")


def both(*conditions):
    """The conjunction, in a fixed order and without repetitions."""
    parts = {}
    for condition in conditions:
        for part in condition.args if condition.op == "and" else (condition,):
            if part is FALSE:
                return FALSE
            if part is not TRUE:
                parts[part.id] = part
    if any(negate(part).id in parts for part in parts.values()):
        return FALSE
    if len(parts) < 2:
        return next(iter(parts.values()), TRUE)
    return make("and", tuple(parts[k] for k in sorted(parts)), "b")


def either(*conditions):
    """The disjunction."""
    return negate(both(*(negate(c) for c in conditions)))


def differ(a, b):
    """Exclusive or."""
    if a is b:
        return FALSE
    return either(both(a, negate(b)), both(negate(a), b))


def of_truths(condition, a, b):
    """The choice of two conditions, where one of them is constant; else None."""
    if a is TRUE:
        return either(condition, b)
    if a is FALSE:
        return both(negate(condition), b)
    if b is TRUE:
        return either(negate(condition), a)
    return both(condition, a) if b is FALSE else None


def joined(condition, a, b):
    """The choice where an operand is a choice with the same result or condition; else
    None."""
    if b.op == "choice":
        other, x, y = b.args
        if other is condition:
            return choose(condition, a, y)
        if y is a:
            return choose(both(negate(condition), other), x, a)
        if x is a:
            return choose(either(condition, other), a, y)
    if a.op == "choice":
        other, x, y = a.args
        if other is condition:
            return choose(condition, x, b)
        if y is b:
            return choose(both(condition, other), x, b)
        if x is b:
            return choose(both(condition, negate(other)), y, b)
    return None


def choose(condition, a, b):
    """condition ? a : b. A choice of numbers is written with the sign of its first
    operand outside, one of the bits of numbers as the bits of a choice, and one of
    joined parts by parts."""
    if condition is TRUE or a is b:
        return a
    if condition is FALSE:
        return b
    if condition.op == "not":
        return choose(condition.args[0], b, a)
    found = of_truths(condition, a, b) if a.sort == "b" else None
    found = found or joined(condition, a, b)
    if found:
        return found
    if is_float(a.sort) and is_negative(a):
        return floats.neg(choose(condition, floats.neg(a), floats.neg(b)))
    if a.op == "bits" and b.op == "bits":
        return floats.bits(choose(condition, a.args[0], b.args[0]))
    parts = words.in_parts(a, b)
    if parts:
        return words.join(*(choose(condition, x, y) for x, y in parts))
    return make("choice", (condition, a, b), a.sort)


def is_negative(a):
    """Whether a term is written with a sign."""
    if a.op == "float":
        return bool(a.args[0] >> (WIDTH[a.sort] - 1))
    return a.op == "neg"


def push(function, name, a):
    """function(choice) as the choice of function of both; name tells functions
    apart."""
    memo, key = TABLE.memos["push"], (name, a.id)
    if key not in memo:
        condition, x, y = a.args
        memo[key] = choose(condition, function(x), function(y))
    return memo[key]


def of_constants(function, a, b=None):
    """function where an operand is a choice of constants and the other one is a
    constant or such a choice, as the choice of its values; else None."""
    one, two = words.is_flag(a), words.is_flag(b)
    if one and two and a.args[0] is b.args[0]:
        return choose(a.args[0], function(a.args[1], b.args[1]),
                      function(a.args[2], b.args[2]))
    if one and (two or b.op == "int"):
        return choose(a.args[0], function(a.args[1], b), function(a.args[2], b))
    if two and a.op == "int":
        return choose(b.args[0], function(a, b.args[1]), function(a, b.args[2]))
    return None
