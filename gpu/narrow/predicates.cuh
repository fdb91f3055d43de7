/* SPDX-License-Identifier: Apache-2.0 */
/* Exact orientation predicates on the device in two stages: a floating-point
 * filter in binary64, then big integers if the caller has an arena for them.
 * spec/narrow/audit.md §2 */
#ifndef GPU_PREDICATES_CUH
#define GPU_PREDICATES_CUH

#include "gpu/narrow/big.cuh"

extern "C" {
#include "ref/narrow/tritri.h"
}

/* Error bounds of §2.1, equal to ref/narrow/predicates.c; ci/prove.sh checks
 * both. */
#define ERROR_ORIENT3 0x1p-49
#define ERROR_ORIENT2 0x1p-50
#define UNDERFLOW 0x1p-1000

/* Words of an arena: 12 coordinates and 9 differences of at most 39 words each,
 * and products of three. */
enum { SIGNS_ROOM = 2048 };

/* The context of exact signs. Without an arena a sign that the filter cannot
 * decide is returned as 0, and `unsure` is set: then no conclusion may be drawn
 * from the signs. */
struct signs {
    struct big_arena *room; /* or NULL */
    bool unsure;            /* out */
};

/* §2.2: turns n numbers into integers in units of their common lowest bit. */
static __device__ inline void to_integers(struct big_arena *m, int n,
                                          const double *x, struct big *r)
{
    int e = 2000;
    for (int k = 0; k < n; k++)
        if (x[k] != 0)
            e = min_of(e, lowest_bit(x[k]));
    m->used = 0;
    for (int k = 0; k < n; k++)
        r[k] = big_make(m, x[k], e);
}

/* Returns the sign of (b - a) × (c - a) · (d - a). */
static __device__ __noinline__ int orient3_integer(struct big_arena *m,
                                                   const point a, const point b,
                                                   const point c, const point d)
{
    double x[12];
    struct big w[12], r[9];
    for (int k = 0; k < 3; k++) {
        x[k] = a[k];
        x[3 + k] = b[k];
        x[6 + k] = c[k];
        x[9 + k] = d[k];
    }
    to_integers(m, 12, x, w);
    for (int k = 0; k < 9; k++)
        r[k] = big_sub(m, w[3 + k], w[k % 3]);
    struct big sum = big_zero();
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        struct big two = big_det(m, r[i], r[3 + j], r[j], r[3 + i]);
        sum = big_add(m, sum, big_mul(m, two, r[6 + k]));
    }
    return big_sign(sum);
}

/* Returns the sign of (b - a) × (c - a) in two coordinates. */
static __device__ __noinline__ int orient2_integer(struct big_arena *m,
                                                   const double x[6])
{
    struct big w[6];
    to_integers(m, 6, x, w);
    struct big bu = big_sub(m, w[2], w[0]), bv = big_sub(m, w[3], w[1]);
    struct big cu = big_sub(m, w[4], w[0]), cv = big_sub(m, w[5], w[1]);
    return big_sign(big_det(m, bu, cv, bv, cu));
}

/* §2.1: filters. */

static __device__ __noinline__ int orient3(struct signs *s, const point a,
                                           const point b, const point c,
                                           const point d)
{
    double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
    double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    double yz = by * cz, zy = bz * cy, zx = bz * cx, xz = bx * cz;
    double xy = bx * cy, yx = by * cx;
    double det = ((yz - zy) * dx + (zx - xz) * dy) + (xy - yx) * dz;
    double sum =
        ((fabs(yz) + fabs(zy)) * fabs(dx) + (fabs(zx) + fabs(xz)) * fabs(dy)) +
        (fabs(xy) + fabs(yx)) * fabs(dz);
    double error = ERROR_ORIENT3 * sum + UNDERFLOW;
    if (fabs(det) > error)
        return det > 0 ? 1 : -1;
    /* §2.3: all differences of one coordinate are 0 */
    if ((bx == 0 && cx == 0 && dx == 0) || (by == 0 && cy == 0 && dy == 0) ||
        (bz == 0 && cz == 0 && dz == 0))
        return 0;
    if (s->room)
        return orient3_integer(s->room, a, b, c, d);
    s->unsure = true;
    return 0;
}

static __device__ __noinline__ int orient2(struct signs *s, const point a,
                                           const point b, const point c, int u,
                                           int v)
{
    double bu = b[u] - a[u], bv = b[v] - a[v];
    double cu = c[u] - a[u], cv = c[v] - a[v];
    double p = bu * cv, q = bv * cu, det = p - q;
    double error = ERROR_ORIENT2 * (fabs(p) + fabs(q)) + UNDERFLOW;
    if (fabs(det) > error)
        return det > 0 ? 1 : -1;
    if ((bu == 0 && cu == 0) || (bv == 0 && cv == 0))
        return 0;
    double x[6] = {a[u], a[v], b[u], b[v], c[u], c[v]};
    if (s->room)
        return orient2_integer(s->room, x);
    s->unsure = true;
    return 0;
}

#endif
