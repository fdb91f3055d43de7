/* SPDX-License-Identifier: Apache-2.0 */
/* Big integers in a bounded arena: exact sums, differences and products.
 * spec/narrow/narrow.md §6.1 */
#include "ref/narrow/big.h"

#include <string.h>

/* From this many words on, multiplying two rows at once is faster. */
#define LONG 12

/* Holds the product of two 64-bit numbers. */
__extension__ typedef unsigned __int128 twice;

/* Takes n words from the arena. If they do not fit, the arena is marked full
 * and starts again at its beginning, so that all accesses stay inside; results
 * are then void. */
static uint32_t *take_words(struct big_arena *m, int n)
{
    if (n > m->size - m->used) {
        m->full = true;
        m->used = 0;
    }
    uint32_t *d = m->word + m->used;
    m->used += n;
    if (m->used > m->most)
        m->most = m->used;
    return d;
}

/* Makes a number from the last n words taken, and gives its leading zero words
 * back to the arena. */
static struct big trim_zeros(struct big_arena *m, uint32_t *d, int n, int sign)
{
    int k = n;
    while (k > 0 && d[k - 1] == 0)
        k--;
    m->used -= n - k;
    struct big r = {d, k, k ? sign : 0};
    return r;
}

static int exponent_bits(uint64_t b)
{
    return (int)(b >> 52 & 0x7ff);
}

/* Splits |x| = *mantissa·2^e and returns e. */
static int unpack_double(double x, uint64_t *mantissa)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    int e = exponent_bits(b);
    *mantissa = b & ((UINT64_C(1) << 52) - 1);
    if (e)
        *mantissa |= UINT64_C(1) << 52;
    return (e ? e : 1) - 1075;
}

int big_exponent(double x)
{
    uint64_t a;
    int e = unpack_double(x, &a);
    for (; !(a & 1); a >>= 1)
        e++;
    return e;
}

struct big big_make(struct big_arena *m, double x, int e)
{
    uint64_t a;
    int shift = unpack_double(x, &a) - e;
    if (a == 0)
        return trim_zeros(m, m->word, 0, 0);
    for (; shift < 0; shift++)
        a >>= 1;
    int low = shift / 32, n = low + 3;
    uint32_t *d = take_words(m, n);
    memset(d, 0, (size_t)n * sizeof *d);
    shift %= 32;
    uint64_t low_half = (a & UINT32_MAX) << shift;
    uint64_t high_half = ((a >> 32) << shift) + (low_half >> 32);
    d[low] = (uint32_t)low_half;
    d[low + 1] = (uint32_t)high_half;
    d[low + 2] = (uint32_t)(high_half >> 32);
    return trim_zeros(m, d, n, x < 0 ? -1 : 1);
}

struct big big_small(struct big_arena *m, uint32_t a)
{
    uint32_t *d = take_words(m, 1);
    d[0] = a;
    return trim_zeros(m, d, 1, 1);
}

struct big big_negate(struct big a)
{
    a.sign = -a.sign;
    return a;
}

/* Compares magnitudes: returns -1, 0 or 1. */
static int compare_magnitudes(struct big a, struct big b)
{
    if (a.n != b.n)
        return a.n < b.n ? -1 : 1;
    for (int i = a.n; i-- > 0;)
        if (a.d[i] != b.d[i])
            return a.d[i] < b.d[i] ? -1 : 1;
    return 0;
}

/* Returns |a| + |b| with a given sign. Requires a.n ≥ b.n. */
static struct big add_magnitudes(struct big_arena *m, struct big a,
                                 struct big b, int sign)
{
    uint32_t *d = take_words(m, a.n + 1);
    uint64_t carry = 0;
    for (int i = 0; i < a.n; i++) {
        carry += (uint64_t)a.d[i] + (i < b.n ? b.d[i] : 0);
        d[i] = (uint32_t)carry;
        carry >>= 32;
    }
    d[a.n] = (uint32_t)carry;
    return trim_zeros(m, d, a.n + 1, sign);
}

/* Returns |a| - |b| with a given sign. Requires |a| ≥ |b|. */
static struct big subtract_magnitudes(struct big_arena *m, struct big a,
                                      struct big b, int sign)
{
    uint32_t *d = take_words(m, a.n), borrow = 0;
    for (int i = 0; i < a.n; i++) {
        uint64_t take = (uint64_t)(i < b.n ? b.d[i] : 0) + borrow;
        borrow = a.d[i] < take;
        d[i] = (uint32_t)(a.d[i] - take);
    }
    return trim_zeros(m, d, a.n, sign);
}

struct big big_add(struct big_arena *m, struct big a, struct big b)
{
    if (a.sign == 0 || b.sign == 0)
        return a.sign ? a : b;
    if (a.sign == b.sign)
        return a.n < b.n ? add_magnitudes(m, b, a, a.sign)
                         : add_magnitudes(m, a, b, a.sign);
    return compare_magnitudes(a, b) < 0 ? subtract_magnitudes(m, b, a, b.sign)
                                        : subtract_magnitudes(m, a, b, a.sign);
}

struct big big_sub(struct big_arena *m, struct big a, struct big b)
{
    return big_add(m, a, big_negate(b));
}

static uint64_t pair_of(const uint32_t *d)
{
    return d[0] | (uint64_t)d[1] << 32;
}

static void set_pair(uint32_t *d, uint64_t a)
{
    uint32_t w[2] = {(uint32_t)a, (uint32_t)(a >> 32)};
    memcpy(d, w, sizeof w);
}

/* Adds x·b to d, where b has n words. d[n] and d[n + 1] must be 0 before. */
static void add_rows(uint32_t *d, uint64_t x, const uint32_t *b, int n)
{
    twice t = 0;
    int j = 0;
    for (; j + 1 < n; j += 2) {
        t += (twice)x * pair_of(b + j) + pair_of(d + j);
        set_pair(d + j, (uint64_t)t);
        t >>= 64;
    }
    if (j < n) {
        t += (twice)x * b[j] + d[j];
        d[j++] = (uint32_t)t;
        t >>= 32;
    }
    set_pair(d + j, (uint64_t)t);
}

/* Returns the index of the first nonzero word of b from j on. Numbers made from
 * mixed exponents are mostly zero words. */
static int skip_zeros(struct big b, int j)
{
    while (j < b.n && b.d[j] == 0)
        j++;
    return j;
}

struct big big_mul_from(struct big_arena *m, struct big a, struct big b,
                        int from)
{
    int n = a.n + b.n - from + 1, low = skip_zeros(b, 0);
    uint32_t *d = take_words(m, n);
    memset(d, 0, (size_t)n * sizeof *d);
    for (int i = skip_zeros(a, 0); i < a.n; i = skip_zeros(a, i + 2)) {
        int j = from - i > low ? from - i : low;
        uint64_t x = i + 1 < a.n ? pair_of(a.d + i) : a.d[i];
        if (j < b.n)
            add_rows(d + i + j - from, x, b.d + j, b.n - j);
    }
    return trim_zeros(m, d, n, a.sign * b.sign);
}

struct big big_mul(struct big_arena *m, struct big a, struct big b)
{
    if (a.n >= LONG && b.n >= LONG)
        return big_mul_from(m, a, b, 0);
    int n = a.n + b.n, low = skip_zeros(b, 0);
    uint32_t *d = take_words(m, n);
    memset(d, 0, (size_t)n * sizeof *d);
    for (int i = 0; i < a.n; i++) {
        uint64_t carry = 0, x = a.d[i];
        if (x == 0)
            continue;
        for (int j = low; j < b.n; j++) {
            carry += x * b.d[j] + d[i + j];
            d[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        d[i + b.n] = (uint32_t)carry;
    }
    return trim_zeros(m, d, n, a.sign * b.sign);
}

struct big big_times(struct big_arena *m, struct big a, uint32_t k)
{
    struct big b = {&k, k != 0, k != 0};
    return big_mul(m, b, a);
}

struct big big_shift(struct big_arena *m, struct big a, int k)
{
    uint32_t *d = take_words(m, a.n + k);
    memset(d, 0, (size_t)k * sizeof *d);
    if (a.n)
        memcpy(d + k, a.d, (size_t)a.n * sizeof *d);
    return trim_zeros(m, d, a.n + k, a.sign);
}

struct big big_keep(struct big_arena *m, int mark, struct big r)
{
    if (m->full)
        return r;
    uint32_t *d = m->word + mark;
    memmove(d, r.d, (size_t)r.n * sizeof *d);
    m->used = mark + r.n;
    r.d = d;
    return r;
}

struct big big_det(struct big_arena *m, struct big a, struct big b,
                   struct big c, struct big d)
{
    int mark = m->used;
    struct big x = big_mul(m, a, b);
    return big_keep(m, mark, big_sub(m, x, big_mul(m, c, d)));
}
