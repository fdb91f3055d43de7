/* SPDX-License-Identifier: Apache-2.0 */
/* A row of the true residual, in binary64 and rounded once.
 * spec/15_pcg.md §2 */
#ifndef GPU_RESIDUAL_CUH
#define GPU_RESIDUAL_CUH

#include "gpu/grid.cuh"
#include "gpu/wide.cuh"
#include "ref/residual.h"

static __device__ inline struct wide whole(const struct residual *s, int p)
{
    struct wide x = widen(s->x[p]), low = widen(s->low[p]);
    return wide3(x.x + low.x, x.y + low.y, x.z + low.z);
}

/* r - a d. */
static __device__ inline struct wide less(struct wide r, sym a, struct wide d)
{
    double xx = (double)a.xx, xy = (double)a.xy, xz = (double)a.xz;
    double yy = (double)a.yy, yz = (double)a.yz, zz = (double)a.zz;
    return sub(r, wide3(dot(wide3(xx, xy, xz), d), dot(wide3(xy, yy, yz), d),
                        dot(wide3(xz, yz, zz), d)));
}

/* b - A (x + low) at one particle. AHEAD directions are read before the first
 * is used, as a thread has nothing else to wait for. */
static __device__ inline vec left_over(const struct residual *s,
                                       struct place at)
{
    enum { AHEAD = 2 };
    struct grid g = {s->m, s->n};
    struct wide x = whole(s, at.p);
    struct wide r = axpy(widen(s->b[at.p]), -(double)s->mass[at.p], x);
    if (s->n_extra)
        r = less(r, s->extra[at.p], x);
    UNROLL
    for (int first = 0; first < SPRINGS; first += AHEAD) {
        sym block[2 * AHEAD];
        struct wide there[2 * AHEAD];
        bool tied[2 * AHEAD];
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++) {
            int o = first + k / 2, sign = k % 2 ? 1 : -1;
            int di = sign * forward_i(o), dj = sign * forward_j(o);
            tied[k] = within(g, at.i + di, at.j + dj);
            int p = tied[k] ? at.p + di + g.m * dj : at.p;
            block[k] = fetch(s->block + o * s->count + (k % 2 ? at.p : p));
            there[k] = whole(s, p);
        }
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++)
            if (tied[k])
                r = less(r, block[k], sub(x, there[k]));
    }
    return narrowed(r);
}

#endif
