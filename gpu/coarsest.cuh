/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid on the device. spec/14_multigrid.md §5 */
#ifndef GPU_COARSEST_CUH
#define GPU_COARSEST_CUH

#include "gpu/grid.cuh"
#include "gpu/team.cuh"
#include "ref/coarsest.h"

/* Fills s.dense with L and 1/D. */
void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s);

/* Of a row in shared memory, odd for the banks. */
static __host__ __device__ inline int dense_pitch(int n)
{
    return n | 1;
}

/* The factor to `a` [n·pitch], 1/D in its diagonal, by a block's threads. */
static __device__ inline void fetch_coarsest(const struct coarsest *s,
                                             double *a)
{
    int n = 3 * (int)s->count, pitch = dense_pitch(n);
    for (int e = (int)rank_thread(); e < n * n; e += rank_threads()) {
        int i = e / n, k = e % n;
        a[i * pitch + k] = s->dense[i == k ? DENSE * DENSE + i : i * DENSE + k];
    }
}

/* z = A⁻¹ b by one rank of at least DENSE threads, all of which must call it, a
 * being seen by all after a barrier of theirs. Thread i owns x[i]: both ways,
 * each unknown that is known is taken from those that are not. */
static __device__ inline void solve_coarsest(const struct coarsest *s,
                                             const double *a, double *x,
                                             const vec *b, vec *z)
{
    int n = 3 * (int)s->count, pitch = dense_pitch(n), t = rank_thread();
    if (t < n)
        x[t] = (double)((const real *)b)[t];
    for (int k = 0; k < n; k++) {
        __syncthreads();
        if (t > k && t < n)
            x[t] -= a[t * pitch + k] * x[k];
    }
    if (t < n)
        x[t] *= a[t * pitch + t];
    for (int k = n - 1; k >= 0; k--) {
        __syncthreads();
        if (t < k)
            x[t] -= a[k * pitch + t] * x[k];
    }
    if (t < n)
        ((real *)z)[t] = (real)x[t];
}

#endif
