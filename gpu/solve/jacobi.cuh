/* SPDX-License-Identifier: Apache-2.0 */
/* Sums, factors and solves diagonal blocks on the device. spec/solve/jacobi.md
 */
#ifndef GPU_JACOBI_CUH
#define GPU_JACOBI_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/solve/jacobi.h"
}

static __device__ inline struct wide_sym widened(real mass)
{
    double a = (double)mass;
    return wide_sym{{a, 0, 0, a, 0, a}};
}

static __device__ inline struct wide_sym add(struct wide_sym d, sym b)
{
    return wide_sym{{d.a[0] + (double)b.xx, d.a[1] + (double)b.xy,
                     d.a[2] + (double)b.xz, d.a[3] + (double)b.yy,
                     d.a[4] + (double)b.yz, d.a[5] + (double)b.zz}};
}

/* §2: returns the factors of L D Lᵀ = d, computed in binary64; all are 0 where
 * the trace of d is not positive. */
static __device__ inline sym factored(struct wide_sym d)
{
    const double *a = d.a;
    double part = REAL_BITS == 32 ? 1.0 / 67108864 : 1.0 / 36028797018963968;
    double least = part * (a[0] + a[3] + a[5]);
    if (!(least > 0))
        return sym{0, 0, 0, 0, 0, 0};
    double x = max_of(a[0], least), l1 = a[1] / x, l2 = a[2] / x;
    double y = max_of(a[3] - l1 * a[1], least), l3 = (a[4] - l1 * a[2]) / y;
    double z = max_of((a[5] - l2 * a[2]) - l3 * l3 * y, least);
    return sym{(real)(1 / x), (real)l1, (real)l2,
               (real)(1 / y), (real)l3, (real)(1 / z)};
}

/* §3: returns the solution z of L D Lᵀ z = r. */
static __device__ inline vec solved(sym f, vec r)
{
    real below = r.y - f.xy * r.x;
    real z = ((r.z - f.xz * r.x) - f.yz * below) * f.zz;
    real y = below * f.yy - f.yz * z;
    return make((r.x * f.xx - f.xy * y) - f.xz * z, y, z);
}

#endif
