/* SPDX-License-Identifier: Apache-2.0 */
/* Exact orientation predicates in two stages: a floating-point filter in
 * binary64, then integers of as many words as the operands need.
 * spec/narrow/audit.md §2 */
#include "ref/narrow/predicates.h"

/* Error bounds of §2.1, proven in spec/proofs/audit_*.gappa. Each is a multiple
 * of the sum of the terms' magnitudes. */
#define ERROR_ORIENT3 0x1p-49
#define ERROR_ORIENT2 0x1p-50
#define UNDERFLOW 0x1p-1000 /* bounds the loss by underflow */

/* §2.2: words of the longest difference. It has bits from 2^61 down to 2^-1074,
 * at most 1136. */
enum { WORDS = 36 };

/* A finite binary64 number as ±m·2^e, with m odd or 0. */
struct parts {
    uint64_t m;
    int e;
    bool negative;
};

/* An integer of n ≤ WORDS words, lowest word first, word[n-1] not 0. */
struct integer {
    uint32_t word[WORDS];
    int n;
    bool negative;
};

/* The sums of a determinant's positive terms, word[0], and negative terms,
 * word[1]. */
struct balance {
    uint32_t word[2][3 * WORDS + 1];
    int n;
};

static struct parts take_apart(double x)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    int biased = (int)(b >> 52) & 2047;
    struct parts r = {b & ((UINT64_C(1) << 52) - 1), 0, b >> 63 != 0};
    if (biased > 0)
        r.m |= UINT64_C(1) << 52;
    r.e = (biased > 0 ? biased : 1) - 1075;
    for (int k = 32; k > 0 && r.m != 0; k /= 2)
        if ((r.m & ((UINT64_C(1) << k) - 1)) == 0) {
            r.m >>= k;
            r.e += k;
        }
    return r;
}

static int bit_length(uint64_t m)
{
    int n = 0;
    for (int k = 32; k > 0; k /= 2)
        if (m >> k != 0) {
            m >>= k;
            n += k;
        }
    return n + (m != 0);
}

/* The least exponent e of all operands, and the number of words of their
 * differences in units of 2^e. */
struct span {
    int e, words;
};

static struct span span_of(const struct parts *p, int n)
{
    int lo = 1024, hi = -1075;
    for (int k = 0; k < n; k++)
        if (p[k].m != 0) {
            int top = p[k].e + bit_length(p[k].m);
            lo = p[k].e < lo ? p[k].e : lo;
            hi = top > hi ? top : hi;
        }
    /* A difference has one bit more. */
    struct span s = {lo, hi < lo ? 1 : (hi - lo + 1 + 31) / 32};
    return s;
}

/* Adds m·2^shift to a number of n words. */
static void add_shifted(uint32_t *word, int n, uint64_t m, int shift)
{
    uint32_t piece[3];
    int at = shift / 32, by = shift % 32;
    piece[0] = (uint32_t)(m << by);
    piece[1] = (uint32_t)(m >> (32 - by));
    piece[2] = (uint32_t)((m >> 32) >> (32 - by));
    uint64_t carry = 0;
    for (int k = at; k < n; k++) {
        carry += (uint64_t)word[k] + (k - at < 3 ? piece[k - at] : 0);
        word[k] = (uint32_t)carry;
        carry >>= 32;
    }
}

static int compare_words(const uint32_t *a, const uint32_t *b, int n)
{
    for (int k = n - 1; k >= 0; k--)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Returns x - y in units of 2^s.e. */
static struct integer subtract_parts(struct parts x, struct parts y,
                                     struct span s)
{
    uint32_t side[2][WORDS] = {{0}};
    if (x.m != 0)
        add_shifted(side[x.negative], s.words, x.m, x.e - s.e);
    if (y.m != 0)
        add_shifted(side[!y.negative], s.words, y.m, y.e - s.e);
    struct integer r;
    r.negative = compare_words(side[0], side[1], s.words) < 0;
    const uint32_t *big = side[r.negative], *small = side[!r.negative];
    uint64_t borrow = 0;
    for (int k = 0; k < s.words; k++) {
        uint64_t d = (uint64_t)big[k] - small[k] - borrow;
        r.word[k] = (uint32_t)d;
        borrow = d >> 63;
    }
    for (r.n = s.words; r.n > 0 && r.word[r.n - 1] == 0;)
        r.n--;
    return r;
}

/* Writes r = a·b, which has na + nb words. */
static void multiply_words(uint32_t *r, const uint32_t *a, int na,
                           const uint32_t *b, int nb)
{
    for (int k = 0; k < na + nb; k++)
        r[k] = 0;
    for (int i = 0; i < na; i++) {
        uint64_t carry = 0;
        for (int j = 0; j < nb; j++) {
            carry += (uint64_t)a[i] * b[j] + r[i + j];
            r[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        r[i + nb] = (uint32_t)carry;
    }
}

/* Adds a term of n words to the sum for its sign. */
static void add_term(struct balance *s, bool negative, const uint32_t *term,
                     int n)
{
    uint32_t *side = s->word[negative];
    uint64_t carry = 0;
    for (int k = 0; k < s->n; k++) {
        carry += (uint64_t)side[k] + (k < n ? term[k] : 0);
        side[k] = (uint32_t)carry;
        carry >>= 32;
    }
}

int ref_orient3_integer(const point a, const point b, const point c,
                        const point d)
{
    const double *const row[4] = {b, c, d, a};
    struct parts p[12];
    for (int k = 0; k < 12; k++)
        p[k] = take_apart(row[k / 3][k % 3]);
    struct span s = span_of(p, 12);
    struct integer m[3][3];
    for (int k = 0; k < 9; k++)
        m[k / 3][k % 3] = subtract_parts(p[k], p[9 + k % 3], s);

    struct balance sum = {.n = 3 * s.words + 1};
    uint32_t two[2 * WORDS], three[3 * WORDS];
    for (int k = 0; k < 6; k++) {
        /* (i, j, l) are the permutations of the columns; k < 3 are even. */
        int i = k % 3, j = (i + (k < 3 ? 1 : 2)) % 3, l = 3 - i - j;
        const struct integer *x = &m[0][i], *y = &m[1][j], *z = &m[2][l];
        if (x->n == 0 || y->n == 0 || z->n == 0)
            continue;
        multiply_words(two, x->word, x->n, y->word, y->n);
        multiply_words(three, two, x->n + y->n, z->word, z->n);
        add_term(&sum, (k >= 3) ^ x->negative ^ y->negative ^ z->negative,
                 three, x->n + y->n + z->n);
    }
    return compare_words(sum.word[0], sum.word[1], sum.n);
}

int ref_orient2_integer(const point a, const point b, const point c, int u,
                        int v)
{
    struct parts p[6] = {take_apart(b[u]), take_apart(b[v]), take_apart(c[u]),
                         take_apart(c[v]), take_apart(a[u]), take_apart(a[v])};
    struct span s = span_of(p, 6);
    struct integer bu = subtract_parts(p[0], p[4], s),
                   bv = subtract_parts(p[1], p[5], s);
    struct integer cu = subtract_parts(p[2], p[4], s),
                   cv = subtract_parts(p[3], p[5], s);
    struct balance sum = {.n = 2 * s.words + 1};
    uint32_t two[2 * WORDS];
    multiply_words(two, bu.word, bu.n, cv.word, cv.n);
    add_term(&sum, bu.negative ^ cv.negative, two, bu.n + cv.n);
    multiply_words(two, bv.word, bv.n, cu.word, cu.n);
    add_term(&sum, !(bv.negative ^ cu.negative), two, bv.n + cu.n);
    return compare_words(sum.word[0], sum.word[1], sum.n);
}

int ref_orient3(const point a, const point b, const point c, const point d)
{
    double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
    double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    double yz = by * cz, zy = bz * cy, zx = bz * cx, xz = bx * cz;
    double xy = bx * cy, yx = by * cx;
    double det = (yz - zy) * dx + (zx - xz) * dy + (xy - yx) * dz;
    double sum = (fabs(yz) + fabs(zy)) * fabs(dx) +
                 (fabs(zx) + fabs(xz)) * fabs(dy) +
                 (fabs(xy) + fabs(yx)) * fabs(dz);
    double err = ERROR_ORIENT3 * sum + UNDERFLOW;
    if (det > err)
        return 1;
    if (det < -err)
        return -1;
    /* §2.3: all differences of one coordinate are 0, so the determinant is
     * exactly 0. */
    if ((bx == 0 && cx == 0 && dx == 0) || (by == 0 && cy == 0 && dy == 0) ||
        (bz == 0 && cz == 0 && dz == 0))
        return 0;
    return ref_orient3_integer(a, b, c, d);
}

int ref_orient2(const point a, const point b, const point c, int u, int v)
{
    double bu = b[u] - a[u], bv = b[v] - a[v];
    double cu = c[u] - a[u], cv = c[v] - a[v];
    double p = bu * cv, q = bv * cu;
    double det = p - q;
    double err = ERROR_ORIENT2 * (fabs(p) + fabs(q)) + UNDERFLOW;
    if (det > err)
        return 1;
    if (det < -err)
        return -1;
    if ((bu == 0 && cu == 0) || (bv == 0 && cv == 0))
        return 0;
    return ref_orient2_integer(a, b, c, u, v);
}
