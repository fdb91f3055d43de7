/* SPDX-License-Identifier: Apache-2.0 */
/* The grids of multigrid on the device. spec/solve/multigrid.md §4, §5 */
#ifndef GPU_LEVEL_CUH
#define GPU_LEVEL_CUH

#include "gpu/solve/coarsest.cuh"
#include "gpu/solve/jacobi.cuh"

extern "C" {
#include "ref/solve/multigrid.h"
}

/* One grid and its streams, fit for a kernel. */
struct level {
    struct grid g;
    int32_t count;
    const real *mass;     /* of the finest grid, where excess is not read */
    const sym *extra;     /* there, or NULL */
    const uint8_t *fixed; /* NULL: all free */
    uint8_t *rule;        /* interpolation to it from the next */
    sym *excess;
    const sym *block;        /* [SPRINGS or STENCIL · count] */
    const struct thin *thin; /* read in its place, or NULL */
    const sym *factor;
    vec *b; /* right-hand side; of the finest grid the caller's */
    vec *x, *y, *d;
    const int32_t *go; /* NULL, or on the device: 0: do nothing */
};

/* §4: the Chebyshev polynomial of degree 2. */
struct weights {
    real first, keep, second;
};

/* The first half-step from 0, which whoever makes the right-hand side takes:
 * y = first·F b. */
struct opening {
    const sym *factor;
    vec *y;
    real first;
};

static __device__ inline void open_at(const struct opening *o, int p, vec b)
{
    o->y[p] = scale(o->first, solved(o->factor[p], b));
}

/* gpu_coarsen of the second grid from the first and so on, by one team; none
 * is the finest. */
#ifdef __CUDACC__
enum { CHAIN_BLOCK = 512, CHAIN_COUNT = 1200 };
#else
enum { CHAIN_BLOCK = 64, CHAIN_COUNT = 200 };
#endif
void gpu_coarsen_chain(struct gpu *g, const struct level *l, int levels);

struct opening gpu_multigrid_opening(const struct multigrid *s);

/* Streams of the finest grid that the caller has room for, in place of the
 * first [count] of pool and the second of room, which are not there then. */
struct lent {
    sym *excess; /* [count] only the build uses it */
    vec *d;      /* [count] only a cycle does */
};

/* The two halves of gpu_multigrid; the cycle comes after its opening. go as in
 * struct level; item [count], where it is not NULL, gets z[p]·r[p]. */
int gpu_multigrid_build(struct gpu *g, struct multigrid *s, struct lent lent);
void gpu_multigrid_cycle(struct gpu *g, struct multigrid *s, struct lent lent,
                         const int32_t *go, real *item);

#endif
