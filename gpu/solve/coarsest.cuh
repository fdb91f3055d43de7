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

static __device__ inline double component(sym b, int r, int c)
{
    int lo = r < c ? r : c, hi = r < c ? c : r;
    real a = lo == 2   ? b.zz
             : lo == 1 ? (hi == 1 ? b.yy : b.yz)
             : hi == 0 ? b.xx
             : hi == 1 ? b.xy
                       : b.xz;
    return (double)a;
}

/* Returns the index of the block that couples particles p < q, or -1 if none
 * does. */
static __device__ inline int edge_of(const struct coarsest *s, struct place p,
                                     struct place q)
{
    int di = q.i - p.i, dj = q.j - p.j, o = -1;
    if (dj == 0)
        o = di == 1 || di == 2 ? di - 1 : -1;
    else if (di >= -2 && di <= 2 && dj <= 2)
        o = di + (dj == 1 ? 4 : 9);
    return o < 0 ? -1 : o * (int)s->count + p.p;
}

/* Returns entry (r, c), c <= r, of the dense matrix. A diagonal entry adds its
 * blocks by ascending first particle. */
static __device__ inline double coarsest_entry(const struct coarsest *s,
                                               const sym *block,
                                               const sym *excess, int r, int c)
{
    struct grid g = {s->m, s->n};
    struct place q = place_of(g, r / 3), p = {0, 0, 0};
    double sum = 0;
    r = r % 3;
    if (q.p != c / 3) {
        int edge = edge_of(s, place_of(g, c / 3), q);
        return edge < 0 ? sum : sum + -component(block[edge], r, c % 3);
    }
    c = c % 3;
    for (; p.p < q.p; p.p++) {
        int edge = edge_of(s, p, q);
        double b = component(block[edge < 0 ? 0 : edge], r, c);
        sum = edge < 0 ? sum : sum + b;
        p.i = p.i + 1 < g.m ? p.i + 1 : 0;
        p.j += p.i == 0;
    }
    sum += component(excess[q.p], r, c);
    for (int o = 0; o < STENCIL; o++) {
        double b = component(block[o * (int)s->count + q.p], r, c);
        bool good =
            within(g, q.i + toward_i<STENCIL>(o), q.j + toward_j<STENCIL>(o));
        sum = good ? sum + b : sum;
    }
    return sum;
}

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
