# SPDX-License-Identifier: Apache-2.0
"""Operations on numbers, rounded to nearest as IEEE 754 has them.

Those on binary32 are done in binary64 and rounded again, which gives the same
result, as binary64 has more than twice the bits of binary32, and two more.
"""
import fractions
import math

from term import bits_of, float_of


def rounded(sort, x):
    """x in a sort."""
    return x if sort == "f64" else float_of(sort, bits_of(sort, x))


def add(sort, a, b):
    """a + b"""
    return rounded(sort, a + b)


def mul(sort, a, b):
    """a · b"""
    return rounded(sort, a * b)


def div(sort, a, b):
    """a / b"""
    if b == 0:
        if a == 0 or a != a:
            return math.nan
        return math.copysign(math.inf, math.copysign(1, a) * math.copysign(1, b))
    return rounded(sort, a / b)


def root(sort, a):
    """√a"""
    return rounded(sort, math.sqrt(a)) if a >= 0 and a < math.inf else (
        a if a == math.inf else math.nan)


def fma(sort, a, b, c):
    """a · b + c, rounded once: for binary32 from a binary64 that is rounded to odd."""
    if not all(map(math.isfinite, (a, b, c))):
        return c if math.isfinite(a) and math.isfinite(b) else rounded(sort, a * b + c)
    whole = fractions.Fraction(a) * fractions.Fraction(b) + fractions.Fraction(c)
    if whole == 0:
        return rounded(sort, a * b + c)
    try:
        near = float(whole)
    except OverflowError:
        return math.inf if whole > 0 else -math.inf
    if sort == "f64" or fractions.Fraction(near) == whole:
        return rounded(sort, near)
    low = near if near < whole else math.nextafter(near, -math.inf)
    odd = low if bits_of("f64", low) & 1 else math.nextafter(low, math.inf)
    return rounded(sort, odd)


def least(a, b):
    """PTX's min."""
    if a != a or b != b:
        return b if a != a else a
    if a == b:
        return a if math.copysign(1, a) < 0 else b
    return min(a, b)


def most(a, b):
    """PTX's max."""
    return -least(-a, -b)


def whole(x, bits, with_sign):
    """x cut to an integer of so many bits, or the nearest that there is; 0 for NaN."""
    low, high = (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) if with_sign else (
        0, (1 << bits) - 1)
    if x != x:
        return 0
    if math.isinf(x):
        x = high if x > 0 else low
    return max(low, min(high, int(x))) & ((1 << bits) - 1)
