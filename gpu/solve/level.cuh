/* SPDX-License-Identifier: Apache-2.0 */
/* The grids of multigrid on the device. spec/solve/multigrid.md §4, §5 */
#ifndef GPU_LEVEL_CUH
#define GPU_LEVEL_CUH

#include "gpu/solve/coarsest.cuh"
#include "gpu/solve/jacobi.cuh"

extern "C" {
#include "ref/solve/multigrid.h"
}

/* One grid and its streams, as kernels take it. */
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
    const int32_t *go; /* NULL, or on the device; *go 0: do nothing */
};

/* §4: the Chebyshev polynomial of degree 2. */
struct weights {
    real first, keep, second;
};

/* The first half-step of a cycle, which starts from 0: y = first·F b. The
 * kernel that makes the right-hand side b does it, too. */
struct opening {
    const sym *factor;
    vec *y;
    real first;
};

static __device__ inline void open_at(const struct opening *o, int p, vec b)
{
    o->y[p] = scale(o->first, solved(o->factor[p], b));
}

/* Makes each grid from the one before, as gpu_coarsen does, all in one kernel
 * of one cluster. The first grid of the chain is made already, and is not the
 * finest. */
#ifdef __CUDACC__
enum { CHAIN_BLOCK = 512, CHAIN_COUNT = 1200 };
#else
enum { CHAIN_BLOCK = 64, CHAIN_COUNT = 200 };
#endif
void gpu_coarsen_chain(struct gpu *g, const struct level *l, int levels);

struct opening gpu_multigrid_opening(const struct multigrid *s);

/* Streams of the finest grid that the caller lends; multigrid's own, the first
 * [count] of pool and the second of room, are not allocated then. */
struct lent {
    sym *excess; /* [count] only the build uses it */
    vec *d;      /* [count] only a cycle does */
};

/* The two halves of gpu_multigrid. The opening must have been done before a
 * cycle. go: as in struct level. item: [count] becomes z[p]·r[p], unless NULL.
 */
int gpu_multigrid_build(struct gpu *g, struct multigrid *s, struct lent lent);
void gpu_multigrid_cycle(struct gpu *g, struct multigrid *s, struct lent lent,
                         const int32_t *go, real *item);

#endif
