/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid on the device. spec/14_multigrid.md §5 */
#ifndef GPU_COARSEST_CUH
#define GPU_COARSEST_CUH

#include "gpu/grid.cuh"
#include "ref/coarsest.h"

/* Fills s.dense with L and 1/D. */
void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s);

/* Of a row in shared memory, odd for the banks. */
enum { PITCH = DENSE + 1 };

/* z = A⁻¹ b by one block of at least DENSE threads, all of which must call it.
 * Thread i owns x[i]: both ways, each unknown that is known is taken from those
 * that are not. */
static __device__ inline void solve_coarsest(const struct coarsest *s,
                                             const vec *b, vec *z)
{
    __shared__ double a[DENSE * (DENSE + 1)], x[DENSE];
    int n = 3 * (int)s->count, t = (int)threadIdx.x;
    for (int e = t; e < n * n; e += (int)blockDim.x)
        a[e / n * PITCH + e % n] = s->dense[e / n * DENSE + e % n];
    if (t < n)
        x[t] = (double)((const real *)b)[t];
    for (int k = 0; k < n; k++) {
        __syncthreads();
        if (t > k && t < n)
            x[t] -= a[t * PITCH + k] * x[k];
    }
    if (t < n)
        x[t] *= s->dense[DENSE * DENSE + t];
    for (int k = n - 1; k >= 0; k--) {
        __syncthreads();
        if (t < k)
            x[t] -= a[k * PITCH + t] * x[k];
    }
    if (t < n)
        ((real *)z)[t] = (real)x[t];
}

#endif
