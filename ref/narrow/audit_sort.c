/* SPDX-License-Identifier: Apache-2.0 */
/* Sorts the triangles of stage audit along a Morton curve, and sorts its pairs.
 * spec/narrow/audit.md §4 */
#include "ref/narrow/audit_sort.h"

struct audit_box ref_audit_box(const vec *x, const int32_t v[3])
{
    vec a = x[v[0]], b = x[v[1]], c = x[v[2]];
    struct audit_box r = {vec_min(vec_min(a, b), c), vec_max(vec_max(a, b), c)};
    return r;
}

/* Spreads the low 21 bits of b, with two zero bits between neighbours
 * (§4.1). */
static uint64_t spread_bits(uint64_t b)
{
    b = (b | b << 32) & UINT64_C(0x001f00000000ffff);
    b = (b | b << 16) & UINT64_C(0x001f0000ff0000ff);
    b = (b | b << 8) & UINT64_C(0x100f00f00f00f00f);
    b = (b | b << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (b | b << 2) & UINT64_C(0x1249249249249249);
}

/* Returns the Morton cell, of 2^21 cells over `size`, that holds the middle of
 * lo and hi. */
static uint64_t morton_cell(real lo, real hi, real from, real size)
{
    real c = lo + (hi - lo) * R(0.5);
    return size > 0 ? (uint64_t)((c - from) / size * R(2097151.0)) : 0;
}

/* Makes the Morton keys. The top bit puts group 0 first. */
static void make_keys(const struct audit_order *s)
{
    vec lo = s->x[0], hi = s->x[0];
    for (int64_t k = 1; k < s->nv; k++) {
        lo = vec_min(lo, s->x[k]);
        hi = vec_max(hi, s->x[k]);
    }
    vec d = vec_sub(hi, lo);
    real size = real_max(real_max(d.x, d.y), d.z);
    EACH_ITEM
    for (int64_t t = 0; t < s->nt; t++) {
        struct audit_box b = ref_audit_box(s->x, s->tri[t]);
        s->key[0][t] =
            spread_bits(morton_cell(b.lo.x, b.hi.x, lo.x, size)) |
            spread_bits(morton_cell(b.lo.y, b.hi.y, lo.y, size)) << 1 |
            spread_bits(morton_cell(b.lo.z, b.hi.z, lo.z, size)) << 2;
        if (s->group == NULL || s->group[t] != 0)
            s->key[0][t] |= UINT64_C(1) << 63;
        s->order[0][t] = (int32_t)t;
    }
}

/* One pass of a radix sort: a stable sort by the 11 bits from `shift` on, from
 * buffer `from` to the other buffer. Returns false, with nothing moved, where
 * these bits are the same in all keys. */
static bool sort_digit(const struct audit_order *s, int from, int shift)
{
    int64_t at[2049] = {0};
    const uint64_t *key = s->key[from];
    for (int64_t t = 0; t < s->nt; t++)
        at[(key[t] >> shift & 2047) + 1]++;
    for (int k = 0; k < 2048; k++) {
        if (at[k + 1] == s->nt)
            return false;
        at[k + 1] += at[k];
    }
    for (int64_t t = 0; t < s->nt; t++) {
        int64_t to = at[key[t] >> shift & 2047]++;
        s->key[!from][to] = key[t];
        s->order[!from][to] = s->order[from][t];
    }
    return true;
}

void ref_audit_order(const struct audit_order *s)
{
    make_keys(s);
    int from = 0;
    for (int shift = 0; shift < 64; shift += 11)
        if (sort_digit(s, from, shift))
            from = !from;
    if (from == 1)
        for (int64_t t = 0; t < s->nt; t++)
            s->order[0][t] = s->order[1][t];
}

static bool comes_before(const int32_t a[2], const int32_t b[2])
{
    return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]);
}

static void swap_pairs(int32_t a[2], int32_t b[2])
{
    for (int j = 0; j < 2; j++) {
        int32_t v = a[j];
        a[j] = b[j];
        b[j] = v;
    }
}

static void sift_down(int32_t (*p)[2], int64_t k, int64_t n)
{
    for (int64_t c = 2 * k + 1; c < n; k = c, c = 2 * k + 1) {
        if (c + 1 < n && comes_before(p[c], p[c + 1]))
            c++;
        if (!comes_before(p[k], p[c]))
            return;
        swap_pairs(p[k], p[c]);
    }
}

void ref_audit_sort(int32_t (*p)[2], int64_t n)
{
    for (int64_t k = n / 2; k-- > 0;)
        sift_down(p, k, n);
    while (n-- > 1) {
        swap_pairs(p[0], p[n]);
        sift_down(p, 0, n);
    }
}
