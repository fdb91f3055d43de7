/* SPDX-License-Identifier: Apache-2.0 */
/* Factors and solves the system of the coarsest grid on the device.
 * spec/solve/multigrid.md §5 */
#ifndef GPU_COARSEST_CUH
#define GPU_COARSEST_CUH

#include "gpu/base/cluster.cuh"
#include "gpu/solve/grid.cuh"

extern "C" {
#include "ref/solve/coarsest.h"
}

/* Fills s.dense with L and 1/D. */
void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s);

/* Returns the pitch of a row in shared memory: odd, to avoid bank conflicts. */
static __host__ __device__ inline int dense_pitch(int n)
{
    return n | 1;
}

/* Copies the factor L, with 1/D on its diagonal, to `a` [n·pitch] in shared
 * memory. All threads of a block must call it. */
static __device__ inline void fetch_coarsest(const struct coarsest *s,
                                             double *a)
{
    int n = 3 * (int)s->count, pitch = dense_pitch(n);
    for (int e = (int)rank_thread(); e < n * n; e += rank_threads()) {
        int i = e / n, k = e % n;
        a[i * pitch + k] = s->dense[i == k ? DENSE * DENSE + i : i * DENSE + k];
    }
}

/* Solves z = A⁻¹ b. All threads of a block call it after fetch_coarsest and a
 * barrier; its first warp does the work. A lane owns one or two unknowns. In
 * both substitutions each unknown, once it is known, is eliminated from the
 * others. */
static __device__ inline void
solve_coarsest(const struct coarsest *s, const double *a, const vec *b, vec *z)
{
    enum { OWN = 2 };
    static_assert(OWN * WARP >= DENSE, "unknowns of a warp");
    int n = 3 * (int)s->count, pitch = dense_pitch(n), t = rank_thread();
    double x[OWN] = {0, 0};
    if (t >= whole_warps(1))
        return;
    int end = t < WARP ? n : 0; /* a lane's are t and t + WARP before it */
    UNROLL
    for (int e = 0; e < OWN; e++)
        if (t + WARP * e < end)
            x[e] = (double)((const real *)b)[t + WARP * e];
    for (int k = 0; k < n; k++) {
        double known = lane_value(k < WARP ? x[0] : x[1], k % WARP);
        UNROLL
        for (int e = 0; e < OWN; e++) {
            int i = t + WARP * e;
            if (i > k && i < end)
                x[e] -= a[i * pitch + k] * known;
        }
    }
    UNROLL
    for (int e = 0; e < OWN; e++)
        if (t + WARP * e < end)
            x[e] *= a[(t + WARP * e) * (pitch + 1)];
    for (int k = n - 1; k >= 0; k--) {
        double known = lane_value(k < WARP ? x[0] : x[1], k % WARP);
        UNROLL
        for (int e = 0; e < OWN; e++) {
            int i = t + WARP * e;
            if (i < k && i < end)
                x[e] -= a[k * pitch + i] * known;
        }
    }
    UNROLL
    for (int e = 0; e < OWN; e++)
        if (t + WARP * e < end)
            ((real *)z)[t + WARP * e] = (real)x[e];
}

#endif
