/* SPDX-License-Identifier: Apache-2.0 */
/* Inverts the operator of the coarsest grid on the device, and solves with it.
 * spec/solve/multigrid.md §5 */
#ifndef GPU_COARSEST_CUH
#define GPU_COARSEST_CUH

#include "gpu/base/cluster.cuh"
#include "gpu/solve/grid.cuh"

extern "C" {
#include "ref/solve/coarsest.h"
}

/* Fills s.dense with the inverse. */
void gpu_coarsest_invert(struct gpu *g, const struct coarsest *s);

/* Starts to copy the rows of the inverse to byte `at` of shared memory. All
 * threads of a block must call it. */
static __device__ inline void fetch_coarsest(const struct coarsest *s, int at)
{
    double *to = (double *)(cluster_shared() + at);
    for (int e = rank_thread(); e < 3 * (int)s->count * DENSE;
         e += rank_threads())
        copy_ahead(to + e, s->dense + e);
}

/* Returns unknown i of the solution; b begins at byte `from` of shared memory,
 * in slots. */
static __device__ inline real coarsest_row(const struct coarsest *s, int at,
                                           const real *b, int i)
{
    const double *a = (const double *)(cluster_shared() + at) + i;
    double sum = 0;
    for (int p = 0; p < (int)s->count; p++, a += 3 * DENSE, b += 4) {
        sum += a[0] * (double)b[0];
        sum += a[DENSE] * (double)b[1];
        sum += a[2 * DENSE] * (double)b[2];
    }
    return (real)sum;
}

#endif
