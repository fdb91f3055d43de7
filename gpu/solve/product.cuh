/* SPDX-License-Identifier: Apache-2.0 */
/* Computes one row of the system's matrix times a vector. spec/solve/product.md
 * §1 */
#ifndef GPU_PRODUCT_CUH
#define GPU_PRODUCT_CUH

#include "gpu/solve/grid.cuh"

extern "C" {
#include "ref/solve/product.h"
}

/* Returns the part of a row that belongs to no edge, from mass or from excess.
 * Adding 0 turns -0 into +0. */
static __device__ inline vec own(real mass, vec x)
{
    return add(scale(mass, x), make(0, 0, 0));
}

static __device__ inline vec own(sym excess, vec x)
{
    return add(apply(excess, x), make(0, 0, 0));
}

/* Returns row p of the compressed diagonals times x. */
static __device__ inline vec cdf_row(const struct product *s,
                                     const struct cdf *c, struct place at)
{
    struct grid g = {s->m, s->n};
    vec here = s->x[at.p], y = own(s->mass[at.p], here);
    if (s->n_extra)
        y = add(y, apply(s->extra[at.p], here));
    UNROLL
    for (int k = 1; k < DIAGONALS; k++) {
        /* In each direction the backward diagonal comes before the forward one,
         * §1. */
        int diagonal = k % 2 ? k + 1 : k - 1, sign = k % 2 ? -1 : 1;
        int o = (k - 1) / 2;
        if (!within(g, at.i + sign * forward_i(o), at.j + sign * forward_j(o)))
            continue;
        const mat *a = s->cdf + (c->start[diagonal] + at.p);
        vec d = sub(s->x[at.p + c->offset[diagonal]], here);
        y = add(y, make(dot(a->x, d), dot(a->y, d), dot(a->z, d)));
    }
    return y;
}

#endif
