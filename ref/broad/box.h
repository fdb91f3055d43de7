/* SPDX-License-Identifier: Apache-2.0 */
/* Axis-aligned bounding boxes (AABBs) whose sides move linearly over a step,
 * and the test of whether two such boxes come within a distance of each other
 * at a common time. spec/broad/refit.md §2, §3 */
#ifndef REF_BOX_H
#define REF_BOX_H

#include "ref/base/real.h"

/* The unit roundoff u: the largest relative error of one rounding. */
#define REAL_UNIT R(REAL_BITS == 32 ? 0x1p-24 : 0x1p-53)
/* Safety margins of §3 in units of u. spec/proofs/box_*.gappa proves that they
 * cover all roundings. */
#define BOX_REACH 16 /* margin of the reach r */
#define BOX_LATE 32  /* margin of the compared times */

/* A moving AABB. At time t the box spans lo0 + t (lo1 - lo0) to hi0 + t (hi1 -
 * hi0). */
struct box {
    vec lo0, hi0, lo1, hi1; /* m */
};

static inline struct box box_point(vec x0, vec x1)
{
    struct box b = {x0, x0, x1, x1};
    return b;
}

static inline struct box box_join(struct box a, struct box b)
{
    struct box c = {vec_min(a.lo0, b.lo0), vec_max(a.hi0, b.hi0),
                    vec_min(a.lo1, b.lo1), vec_max(a.hi1, b.hi1)};
    return c;
}

static inline struct box box_vertex(const vec *x0, const vec *x1, int32_t v)
{
    return box_point(x0[v], x1[v]);
}

static inline struct box box_edge(const vec *x0, const vec *x1, int32_t a,
                                  int32_t b)
{
    return box_join(box_vertex(x0, x1, a), box_vertex(x0, x1, b));
}

static inline struct box box_face(const vec *x0, const vec *x1,
                                  const int32_t f[3])
{
    return box_join(box_edge(x0, x1, f[0], f[1]), box_vertex(x0, x1, f[2]));
}

/* Returns the inflated reach that box_meets takes, §3: r plus the margin for
 * roundings. */
static inline real box_reach(real r)
{
    return r * (1 + BOX_REACH * REAL_UNIT);
}

/* The two signed gaps of two boxes a and b on one axis, each at t = 0 and t =
 * 1. Gap g is from a's low side to b's high side, gap h from b's low side to
 * a's high side, both plus the reach. A negative gap means that the boxes are
 * apart. */
struct box_gaps {
    real g0, g1, h0, h1;
};

static inline struct box_gaps box_axis(real alo0, real ahi0, real alo1,
                                       real ahi1, real blo0, real bhi0,
                                       real blo1, real bhi1, real reach)
{
    struct box_gaps g = {(bhi0 - alo0) + reach, (bhi1 - alo1) + reach,
                         (ahi0 - blo0) + reach, (ahi1 - blo1) + reach};
    return g;
}

/* Narrows the interval of times at which the gap g0 + t (g1 - g0) is not
 * negative. Times are measured as q = (1 - t) / t, which falls as t grows: a
 * gap that opens bounds q from above by *late, a gap that shuts bounds q from
 * below by *early. At least one of g0, g1 must be ≥ 0. §3 */
static inline void box_times(real g0, real g1, real *late, real *early)
{
    if (g0 < 0)
        *late = real_min(*late, g1 / -g0);
    else if (g1 < 0)
        *early = real_max(*early, -g1 / g0);
}

static inline bool box_meets_late(const struct box_gaps g[3])
{
    real late = R(INFINITY), early = 0;
    for (int k = 0; k < 3; k++) {
        box_times(g[k].g0, g[k].g1, &late, &early);
        box_times(g[k].h0, g[k].h1, &late, &early);
    }
    return !(late * (1 + BOX_LATE * REAL_UNIT) + R(0x1p-100) < early);
}

/* Whether some gap of one axis is negative at both ends, so that the boxes are
 * apart at all times. *least becomes the least gap seen so far. */
static inline bool box_apart(const struct box_gaps *g, real *least)
{
    real low = real_min(real_min(g->g0, g->g1), real_min(g->h0, g->h1));
    *least = real_min(*least, low);
    return real_max(g->g0, g->g1) < 0 || real_max(g->h0, g->h1) < 0;
}

/* The overlap test of the broad phase. It is conservative: false only if at no
 * t in [0, 1] a point of a lies within r of a point of b on all three axes;
 * reach = box_reach(r). It is monotone: larger boxes never turn true into
 * false. §3 */
static inline bool box_meets(const struct box *a, const struct box *b,
                             real reach)
{
    struct box_gaps g[3];
    real least = 0;
    g[0] = box_axis(a->lo0.x, a->hi0.x, a->lo1.x, a->hi1.x, b->lo0.x, b->hi0.x,
                    b->lo1.x, b->hi1.x, reach);
    if (box_apart(&g[0], &least))
        return false;
    g[1] = box_axis(a->lo0.y, a->hi0.y, a->lo1.y, a->hi1.y, b->lo0.y, b->hi0.y,
                    b->lo1.y, b->hi1.y, reach);
    if (box_apart(&g[1], &least))
        return false;
    g[2] = box_axis(a->lo0.z, a->hi0.z, a->lo1.z, a->hi1.z, b->lo0.z, b->hi0.z,
                    b->lo1.z, b->hi1.z, reach);
    /* If no gap is ever negative, the boxes meet all the time, and there are no
     * times to compare. */
    return !box_apart(&g[2], &least) && (!(least < 0) || box_meets_late(g));
}

#endif
