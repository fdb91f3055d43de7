/* SPDX-License-Identifier: Apache-2.0 */
/* Computes one row of the true residual, in binary64 and rounded once.
 * spec/solve/pcg.md §2 */
#ifndef GPU_RESIDUAL_CUH
#define GPU_RESIDUAL_CUH

#include "gpu/base/wide.cuh"
#include "gpu/solve/grid.cuh"

extern "C" {
#include "ref/solve/pcg.h"
}

static __device__ inline struct wide solution_of(const struct pcg *s, int p)
{
    struct wide x = widen(s->dv[p]), low = widen(s->low[p]);
    return wide3(x.x + low.x, x.y + low.y, x.z + low.z);
}

/* Returns r - a d. */
static __device__ inline struct wide subtract_product(struct wide r, sym a,
                                                      struct wide d)
{
    double xx = (double)a.xx, xy = (double)a.xy, xz = (double)a.xz;
    double yy = (double)a.yy, yz = (double)a.yz, zz = (double)a.zz;
    return sub(r, wide3(dot(wide3(xx, xy, xz), d), dot(wide3(xy, yy, yz), d),
                        dot(wide3(xz, yz, zz), d)));
}

/* Returns b - A (dv + low) at one particle. */
static __device__ inline vec left_over(const struct pcg *s, struct place at)
{
    struct grid g = {s->m, s->n};
    struct wide x = solution_of(s, at.p);
    struct wide r = axpy(widen(s->b[at.p]), -(double)s->mass[at.p], x);
    if (s->n_extra)
        r = subtract_product(r, s->extra[at.p], x);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        int di = forward_i(o), dj = forward_j(o);
        int before = at.p - (di + g.m * dj), after = at.p + (di + g.m * dj);
        if (within(g, at.i - di, at.j - dj))
            r = subtract_product(r, fetch(block + before),
                                 sub(x, solution_of(s, before)));
        if (within(g, at.i + di, at.j + dj))
            r = subtract_product(r, fetch(block + at.p),
                                 sub(x, solution_of(s, after)));
    }
    return narrowed(r);
}

#endif
