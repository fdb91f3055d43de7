/* SPDX-License-Identifier: Apache-2.0 */
/* Truncated big integers: only the leading words are kept, with an error bound.
 * spec/narrow/narrow.md §6.6 */
#include "ref/narrow/approx.h"

uint32_t approx_rest(struct big a)
{
    uint64_t r = 0;
    for (int i = a.n; i-- > 0;) /* 2^32 ≡ 5; r stays below 2^36 */
        r = ((r >> 32) * 5 + (uint32_t)r) * 5 + a.d[i];
    r %= APPROX_PRIME;
    return (uint32_t)(a.sign < 0 && r ? APPROX_PRIME - r : r);
}

/* Drops the lowest k words, which loses less than one unit of the lowest word
 * kept. */
static struct approx drop_words(struct approx a, int k)
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

struct approx approx_of(const struct big_arena *m, struct big a)
{
    struct approx r = {.m = a,
                       .rest = m->keep < APPROX_REST ? 0 : approx_rest(a)};
    return drop_words(r, a.n - m->keep);
}

struct approx approx_few(struct approx a)
{
    return drop_words(a, a.m.n - APPROX_FEW);
}

/* Rewrites a in units of 2^(32 low). Words are dropped, or zero words are added
 * below an exact number. */
static struct approx align_to(struct big_arena *m, struct approx a, int low)
{
    if (a.m.n == 0 && a.err == 0)
        a.low = low;
    if (low < a.low) {
        a.m = big_shift(m, a.m, a.low - low);
        a.low = low;
    }
    return drop_words(a, low - a.low);
}

static int larger_of(int a, int b)
{
    return a > b ? a : b;
}

struct approx approx_add(struct big_arena *m, struct approx a, struct approx b)
{
    if (a.m.n == 0 && a.err == 0)
        return b;
    if (b.m.n == 0 && b.err == 0)
        return a;
    int top = larger_of(a.low + a.m.n, b.low + b.m.n);
    int low = larger_of(a.low < b.low ? a.low : b.low, top - m->keep);
    /* only an exact number may change to a smaller unit */
    low = larger_of(low, a.err ? a.low : low);
    low = larger_of(low, b.err ? b.low : low);
    a = align_to(m, a, low);
    b = align_to(m, b, low);
    uint64_t rest = (uint64_t)a.rest + b.rest;
    struct approx r = {.m = big_add(m, a.m, b.m),
                       .low = low,
                       .err = a.err + b.err,
                       .rest = (uint32_t)(rest % APPROX_PRIME)};
    return r;
}

struct approx approx_negate(struct approx a)
{
    a.m = big_negate(a.m);
    a.rest = a.rest ? APPROX_PRIME - a.rest : 0;
    return a;
}

struct approx approx_sub(struct big_arena *m, struct approx a, struct approx b)
{
    return approx_add(m, a, approx_negate(b));
}

struct approx approx_mul(struct big_arena *m, struct approx a, struct approx b)
{
    uint32_t rest = (uint32_t)((uint64_t)a.rest * b.rest % APPROX_PRIME);
    int k = a.m.n + b.m.n - 1 - m->keep;
    if (k <= 0 && a.err == 0 && b.err == 0) {
        struct approx exact = {
            .m = big_mul(m, a.m, b.m), .low = a.low + b.low, .rest = rest};
        return exact;
    }
    /* The error is below a.err |b| + b.err |a| + a.err b.err. Dropping as many
     * words as the factor beside each error has leaves at most a.err + b.err +
     * 1. */
    k = larger_of(k, larger_of(a.err ? b.m.n : 0, b.err ? a.m.n : 0));
    k = larger_of(k, 1);
    /* products more than two words below the kept words add less than one
     * unit */
    int from = larger_of(k - 3, 0);
    struct approx r = {.m = big_mul_from(m, a.m, b.m, from),
                       .low = a.low + b.low + from,
                       .rest = rest};
    r = drop_words(r, k - from);
    r.err = a.err + b.err + 3;
    return r;
}

struct approx approx_times(struct big_arena *m, struct approx a, uint32_t k)
{
    struct approx b = {{&k, k != 0, k != 0}, 0, 0, k};
    return approx_mul(m, b, a);
}

int approx_sign(struct approx a)
{
    if (a.err == 0 || a.m.n > 1 || (a.m.n == 1 && a.m.d[0] > a.err))
        return a.m.sign;
    return APPROX_UNKNOWN;
}

int approx_decide(struct big_arena *m, struct approx a)
{
    int sign = approx_sign(a);
    if (sign == APPROX_UNKNOWN && a.rest == 0 && m->keep >= APPROX_REST)
        m->keep = INT32_MAX / 4;
    return sign;
}
