/* SPDX-License-Identifier: Apache-2.0 */
/* The grids (levels) of multigrid on the device, and the functions that build
 * and run a cycle. spec/solve/multigrid.md §4, §5 */
#ifndef GPU_LEVEL_CUH
#define GPU_LEVEL_CUH

#include "gpu/solve/coarsest.cuh"
#include "gpu/solve/jacobi.cuh"

extern "C" {
#include "ref/solve/multigrid.h"
}

/* One grid of the hierarchy and its streams, in the form that kernels take. */
struct level {
    struct grid g;
    int32_t count;
    const real *mass;     /* of the finest grid, which reads no excess */
    const sym *extra;     /* of the finest grid; NULL: none */
    const uint8_t *fixed; /* NULL: all particles are free */
    uint8_t *rule;        /* rules of interpolation from the next grid */
    sym *excess;
    const sym *block;            /* [SPRINGS or STENCIL · count] */
    const struct packed *packed; /* read in place of block, unless NULL */
    const sym *factor;           /* of the diagonal blocks, jacobi.md §2 */
    vec *b;            /* right-hand side; for the finest grid the caller's r */
    vec *x;            /* on the way down the residual, then the solution */
    vec *y;            /* what is smoothed before x is known */
    const int32_t *go; /* NULL, or on the device: if *go is 0 nothing is done */
};

/* The first smoothing of a cycle, which starts from 0: y = damping·F b. The
 * kernel that computes the right-hand side b also does it. */
struct opening {
    const sym *factor;
    vec *y;
    real damping;
};

static __device__ inline void open_at(const struct opening *o, int p, vec b)
{
    o->y[p] = scale(o->damping, solved(o->factor[p], b));
}

/* Makes each grid of a chain from the grid before, as gpu_coarsen does, but all
 * of them in one kernel of one cluster. The operator of the first grid must
 * have been made; the first grid is not the finest one. */
#ifdef __CUDACC__
enum { CHAIN_BLOCK = 512, CHAIN_COUNT = 1200 };
#else
enum { CHAIN_BLOCK = 64, CHAIN_COUNT = 200 };
#endif
void gpu_coarsen_chain(struct gpu *g, const struct level *l, int levels);

struct opening gpu_multigrid_opening(const struct multigrid *s);
/* §5: fills the list of grids, from fine to coarse, with the places of their
 * streams. Returns how many there are. lent, go: as below. */
int gpu_multigrid_lay_out(const struct multigrid *s, sym *lent,
                          const int32_t *go, struct level *l);
/* §4: the part of F (b - A x) by which grid k is smoothed. */
real gpu_multigrid_damping(const struct multigrid *s, int k);
/* The residual of a grid after y, in x; and y, smoothed, in x. item: as below.
 */
void gpu_multigrid_descend(struct gpu *g, const struct level *l);
void gpu_multigrid_smooth(struct gpu *g, const struct level *l, real damping,
                          real *item);

/* The two halves of gpu_multigrid: the build makes the coarse operators, and a
 * cycle applies them. The opening must have been done before a cycle. go: as in
 * struct level. item: unless NULL, item[p] becomes z[p]·r[p]. lent: unless
 * NULL, the excess of the finest grid [count], which only the build uses; pool
 * then lacks its first [count] items. */
int gpu_multigrid_build(struct gpu *g, struct multigrid *s, sym *lent);
void gpu_multigrid_cycle(struct gpu *g, struct multigrid *s, sym *lent,
                         const int32_t *go, real *item);

#endif
