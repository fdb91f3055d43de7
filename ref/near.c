/* SPDX-License-Identifier: Apache-2.0 */
/* Whole numbers of which only the leading words are kept:
 * spec/30_narrow.md §6.6. */
#include "ref/near.h"

/* Without its lowest k words: less than one unit of those left. */
static struct near drop(struct near a, int k)
{
    if (k <= 0)
        return a;
    /* in the new unit one for the old error, one for what is cut off */
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

struct near near_of(const struct room *m, struct big a)
{
    struct near r = {a, 0, 0};
    return drop(r, a.n - m->keep);
}

/* In units of 2^(32 low): words dropped, or, of an exact number, zeros added
 * below. */
static struct near align(struct room *m, struct near a, int low)
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

struct near near_add(struct room *m, struct near a, struct near b)
{
    if (a.m.n == 0 && a.err == 0)
        return b;
    if (b.m.n == 0 && b.err == 0)
        return a;
    int top = larger(a.low + a.m.n, b.low + b.m.n);
    int low = larger(a.low < b.low ? a.low : b.low, top - m->keep);
    /* only exact numbers can be had in a smaller unit */
    low = larger(low, a.err ? a.low : low);
    low = larger(low, b.err ? b.low : low);
    a = align(m, a, low);
    b = align(m, b, low);
    struct near r = {big_add(m, a.m, b.m), low, a.err + b.err};
    return r;
}

struct near near_negate(struct near a)
{
    a.m = big_negate(a.m);
    return a;
}

struct near near_sub(struct room *m, struct near a, struct near b)
{
    return near_add(m, a, near_negate(b));
}

struct near near_mul(struct room *m, struct near a, struct near b)
{
    int k = a.m.n + b.m.n - 1 - m->keep;
    if (k <= 0 && a.err == 0 && b.err == 0) {
        struct near exact = {big_mul(m, a.m, b.m), a.low + b.low, 0};
        return exact;
    }
    /* a.err |b| + b.err |a| + a.err b.err, of which dropping as many words as
     * either factor has that meets an error leaves a.err + b.err + 1 */
    k = larger(k, larger(a.err ? b.m.n : 0, b.err ? a.m.n : 0));
    k = larger(k, 1);
    /* parts more than two words below those kept are less than a unit */
    int from = larger(k - 3, 0);
    struct near r = {big_mul_from(m, a.m, b.m, from), a.low + b.low + from, 0};
    r = drop(r, k - from);
    r.err = a.err + b.err + 3;
    return r;
}

struct near near_times(struct room *m, struct near a, uint32_t k)
{
    struct near b = {{&k, k != 0, k != 0}, 0, 0};
    return near_mul(m, b, a);
}

int near_sign(struct near a)
{
    if (a.err == 0 || a.m.n > 1 || (a.m.n == 1 && a.m.d[0] > a.err))
        return a.m.sign;
    return NEAR_UNKNOWN;
}
