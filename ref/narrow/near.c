/* SPDX-License-Identifier: Apache-2.0 */
/* Truncated big integers: only the leading words are kept, with an error bound.
 * spec/narrow/narrow.md §6.6 */
#include "ref/narrow/near.h"

uint32_t near_rest(struct big a)
{
    uint64_t r = 0;
    for (int i = a.n; i-- > 0;) /* 2^32 ≡ 5; r stays below 2^36 */
        r = ((r >> 32) * 5 + (uint32_t)r) * 5 + a.d[i];
    r %= NEAR_PRIME;
    return (uint32_t)(a.sign < 0 && r ? NEAR_PRIME - r : r);
}

/* Drops the lowest k words, which loses less than one unit of the lowest word
 * kept. */
static struct near drop(struct near a, int k)
{
    if (k <= 0)
        return a;
    /* in the new unit: one for the old error, one for the words dropped */
    a.err = (a.err > 0) + (a.m.n > 0);
    a.low += k;
    if (k >= a.m.n) {
        a.m.n = a.m.sign = 0;
        return a;
    }
    a.m.d += k;
    a.m.n -= k;
    return a;
}

struct near near_of(const struct big_arena *m, struct big a)
{
    struct near r = {.m = a, .rest = m->keep < NEAR_REST ? 0 : near_rest(a)};
    return drop(r, a.n - m->keep);
}

struct near near_few(struct near a)
{
    return drop(a, a.m.n - NEAR_FEW);
}

/* Rewrites a in units of 2^(32 low). Words are dropped, or zero words are added
 * below an exact number. */
static struct near align(struct big_arena *m, struct near a, int low)
{
    if (a.m.n == 0 && a.err == 0)
        a.low = low;
    if (low < a.low) {
        a.m = big_shift(m, a.m, a.low - low);
        a.low = low;
    }
    return drop(a, low - a.low);
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

struct near near_add(struct big_arena *m, struct near a, struct near b)
{
    if (a.m.n == 0 && a.err == 0)
        return b;
    if (b.m.n == 0 && b.err == 0)
        return a;
    int top = larger(a.low + a.m.n, b.low + b.m.n);
    int low = larger(a.low < b.low ? a.low : b.low, top - m->keep);
    /* only an exact number may change to a smaller unit */
    low = larger(low, a.err ? a.low : low);
    low = larger(low, b.err ? b.low : low);
    a = align(m, a, low);
    b = align(m, b, low);
    uint64_t rest = (uint64_t)a.rest + b.rest;
    struct near r = {.m = big_add(m, a.m, b.m),
                     .low = low,
                     .err = a.err + b.err,
                     .rest = (uint32_t)(rest % NEAR_PRIME)};
    return r;
}

struct near near_negate(struct near a)
{
    a.m = big_negate(a.m);
    a.rest = a.rest ? NEAR_PRIME - a.rest : 0;
    return a;
}

struct near near_sub(struct big_arena *m, struct near a, struct near b)
{
    return near_add(m, a, near_negate(b));
}

struct near near_mul(struct big_arena *m, struct near a, struct near b)
{
    uint32_t rest = (uint32_t)((uint64_t)a.rest * b.rest % NEAR_PRIME);
    int k = a.m.n + b.m.n - 1 - m->keep;
    if (k <= 0 && a.err == 0 && b.err == 0) {
        struct near exact = {
            .m = big_mul(m, a.m, b.m), .low = a.low + b.low, .rest = rest};
        return exact;
    }
    /* The error is below a.err |b| + b.err |a| + a.err b.err. Dropping as many
     * words as the factor beside each error has leaves at most a.err + b.err +
     * 1. */
    k = larger(k, larger(a.err ? b.m.n : 0, b.err ? a.m.n : 0));
    k = larger(k, 1);
    /* products more than two words below the kept words add less than one
     * unit */
    int from = larger(k - 3, 0);
    struct near r = {.m = big_mul_from(m, a.m, b.m, from),
                     .low = a.low + b.low + from,
                     .rest = rest};
    r = drop(r, k - from);
    r.err = a.err + b.err + 3;
    return r;
}

struct near near_times(struct big_arena *m, struct near a, uint32_t k)
{
    struct near b = {{&k, k != 0, k != 0}, 0, 0, k};
    return near_mul(m, b, a);
}

int near_sign(struct near a)
{
    if (a.err == 0 || a.m.n > 1 || (a.m.n == 1 && a.m.d[0] > a.err))
        return a.m.sign;
    return NEAR_UNKNOWN;
}

int near_tell(struct big_arena *m, struct near a)
{
    int sign = near_sign(a);
    if (sign == NEAR_UNKNOWN && a.rest == 0 && m->keep >= NEAR_REST)
        m->keep = INT32_MAX / 4;
    return sign;
}
