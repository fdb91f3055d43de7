/* SPDX-License-Identifier: Apache-2.0 */
/* Big integers in a bounded arena of device memory. Products are computed
 * column by column, so that loads do not wait for stores. spec/narrow/narrow.md
 * §6.1 */
#ifndef GPU_BIG_CUH
#define GPU_BIG_CUH

#include "gpu/base/real.cuh"

/* An arena of words, handed out in order. The caller frees words by restoring
 * `used`. */
struct big_arena {
    uint32_t *word; /* [size] */
    int size, used;
    bool full; /* out: a number did not fit; results are void */
};

/* An integer of |n| words from `at` on, lowest word first, the last not 0; n <
 * 0 means negative. */
struct big {
    int32_t at, n;
};

static __device__ inline int big_sign(struct big a)
{
    return (a.n > 0) - (a.n < 0);
}

static __device__ inline int big_words(struct big a)
{
    return a.n < 0 ? -a.n : a.n;
}

static __device__ inline struct big big_zero(void)
{
    struct big r = {0, 0};
    return r;
}

static __device__ inline struct big big_minus(struct big a)
{
    a.n = -a.n;
    return a;
}

/* Takes n words from the arena. If they do not fit, the arena is marked full
 * and starts again at its beginning, so that all accesses stay inside; results
 * are then void. */
static __device__ inline int room_take(struct big_arena *m, int n)
{
    if (n > m->size - m->used) {
        m->full = true;
        m->used = 0;
    }
    int at = m->used;
    m->used += n;
    return at;
}

/* Makes a number from the last n words taken, and gives its leading zero words
 * back to the arena. */
static __device__ inline struct big big_trim(struct big_arena *m, int at, int n,
                                             bool negative)
{
    int k = n;
    while (k > 0 && m->word[at + k - 1] == 0)
        k--;
    m->used -= n - k;
    struct big r = {at, negative ? -k : k};
    return r;
}

/* Splits |x| = *mantissa·2^e and returns e. */
static __device__ inline int take_apart(double x, uint64_t *mantissa)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    int e = (int)(b >> 52 & 0x7ff);
    *mantissa = b & (((uint64_t)1 << 52) - 1);
    if (e)
        *mantissa |= (uint64_t)1 << 52;
    return (e ? e : 1) - 1075;
}

/* Returns the exponent of the lowest set bit of a finite x ≠ 0. */
static __device__ inline int lowest_bit(double x)
{
    uint64_t a;
    int e = take_apart(x, &a);
    return e + 63 - __clzll((long long)(a & (0 - a)));
}

/* Returns x·2^-e. The caller chooses e so that the result is an integer. */
static __device__ __noinline__ struct big big_make(struct big_arena *m,
                                                   double x, int e)
{
    uint64_t a;
    int shift = take_apart(x, &a) - e;
    if (a == 0)
        return big_zero();
    if (shift < 0) {
        a >>= -shift;
        shift = 0;
    }
    int low = shift / 32, n = low + 3, at = room_take(m, n);
    uint32_t *d = m->word + at;
    for (int k = 0; k < low; k++)
        d[k] = 0;
    shift %= 32;
    uint64_t first = (a & 0xffffffffu) << shift;
    uint64_t second = ((a >> 32) << shift) + (first >> 32);
    d[low] = (uint32_t)first;
    d[low + 1] = (uint32_t)second;
    d[low + 2] = (uint32_t)(second >> 32);
    return big_trim(m, at, n, x < 0);
}

static __device__ inline struct big big_small(struct big_arena *m, uint32_t a)
{
    int at = room_take(m, 1);
    m->word[at] = a;
    return big_trim(m, at, 1, false);
}

/* Whether |a| < |b|. */
static __device__ inline bool big_less(const struct big_arena *m, struct big a,
                                       struct big b)
{
    int n = big_words(a);
    if (n != big_words(b))
        return n < big_words(b);
    for (int k = n - 1; k >= 0; k--) {
        uint32_t x = m->word[a.at + k], y = m->word[b.at + k];
        if (x != y)
            return x < y;
    }
    return false;
}

/* Returns |a| ± |b| with the sign of a. a must have at least as many words as
 * b, and for a difference |a| ≥ |b|. */
static __device__ inline struct big big_carry(struct big_arena *m, struct big a,
                                              struct big b, bool minus)
{
    int na = big_words(a), nb = big_words(b), at = room_take(m, na + 1);
    const uint32_t *x = m->word + a.at, *y = m->word + b.at;
    uint32_t *d = m->word + at, flip = minus ? 0xffffffffu : 0;
    /* x - y = x + ~y + 1, whose last carry is dropped */
    uint64_t carry = minus;
    for (int k = 0; k < nb; k++) {
        carry += (uint64_t)x[k] + (y[k] ^ flip);
        d[k] = (uint32_t)carry;
        carry >>= 32;
    }
    for (int k = nb; k < na; k++) {
        carry += (uint64_t)x[k] + flip;
        d[k] = (uint32_t)carry;
        carry >>= 32;
    }
    d[na] = minus ? 0 : (uint32_t)carry;
    return big_trim(m, at, na + 1, a.n < 0);
}

static __device__ __noinline__ struct big big_add(struct big_arena *m,
                                                  struct big a, struct big b)
{
    if (a.n == 0 || b.n == 0)
        return a.n ? a : b;
    bool minus = (a.n < 0) != (b.n < 0);
    bool swap = minus ? big_less(m, a, b) : big_words(a) < big_words(b);
    return swap ? big_carry(m, b, a, minus) : big_carry(m, a, b, minus);
}

static __device__ inline struct big big_sub(struct big_arena *m, struct big a,
                                            struct big b)
{
    return big_add(m, a, big_minus(b));
}

static __device__ __noinline__ struct big big_mul(struct big_arena *m,
                                                  struct big a, struct big b)
{
    int na = big_words(a), nb = big_words(b), n = na + nb;
    if (na == 0 || nb == 0)
        return big_zero();
    int at = room_take(m, n);
    const uint32_t *x = m->word + a.at, *y = m->word + b.at;
    uint32_t *d = m->word + at;
    int low_x = 0, low_y = 0; /* numbers made from mixed exponents are mostly
                                 zero words */
    while (low_x < na && x[low_x] == 0)
        low_x++;
    while (low_y < nb && y[low_y] == 0)
        low_y++;
    uint64_t sum = 0;
    for (int k = 0; k < n; k++) {
        int from = k - nb + 1 > low_x ? k - nb + 1 : low_x;
        int to = k - low_y < na - 1 ? k - low_y : na - 1;
        uint32_t over = 0;
        for (int i = from; i <= to; i++) {
            uint64_t p = (uint64_t)x[i] * y[k - i];
            sum += p;
            over += sum < p;
        }
        d[k] = (uint32_t)sum;
        sum = sum >> 32 | (uint64_t)over << 32;
    }
    return big_trim(m, at, n, (a.n < 0) != (b.n < 0));
}

/* Moves r down to `mark` and frees every other word taken since then. */
static __device__ inline struct big big_keep(struct big_arena *m, int mark,
                                             struct big r)
{
    int n = big_words(r);
    if (m->full || r.at < mark) {
        m->used = m->full ? m->used : mark;
        return r;
    }
    for (int k = 0; k < n; k++)
        m->word[mark + k] = m->word[r.at + k];
    m->used = mark + n;
    r.at = mark;
    return r;
}

/* Returns a·b - c·d and frees all intermediate words. */
static __device__ __noinline__ struct big big_det(struct big_arena *m,
                                                  struct big a, struct big b,
                                                  struct big c, struct big d)
{
    int mark = m->used;
    struct big p = big_mul(m, a, b);
    return big_keep(m, mark, big_sub(m, p, big_mul(m, c, d)));
}

#endif
