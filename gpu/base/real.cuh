/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of spec/README.md §1 on the device, with the same bits as in
 * ref/. They are written independently of ref/base/real.h: only the types are
 * shared. Functions of headers are static, and structs that have functions are
 * in unnamed namespaces. Otherwise the host's linker could take one precision's
 * function for both, since type names such as vec are the same in both
 * precisions. */
#ifndef GPU_REAL_CUH
#define GPU_REAL_CUH

#include "gpu/run/launch.cuh"

/* §1.2: minimum and maximum; the second operand on ties and on NaN. */
template <class T> static __device__ inline T min_of(T a, T b)
{
    return a < b ? a : b;
}
template <class T> static __device__ inline T max_of(T a, T b)
{
    return a > b ? a : b;
}

static __device__ inline real magnitude(real a)
{
    return a < 0 ? -a : a;
}

static __device__ inline bool sane(real a)
{
    return a >= -REAL_BIG && a <= REAL_BIG;
}

/* §1.3: returns the next larger number by the integer order of the bits; from
 * either zero the smallest subnormal. */
static __device__ inline real above(real a)
{
    real_bits b = 1;
    if (a != 0) {
        memcpy(&b, &a, sizeof b);
        b += a > 0 ? 1 : (real_bits)-1;
    }
    memcpy(&a, &b, sizeof a);
    return a;
}

static __device__ inline real below(real a)
{
    return -above(-a);
}

static __device__ inline real root(real a)
{
#if REAL_BITS == 32
    return sqrtf(a);
#else
    return sqrt(a);
#endif
}

static __device__ inline vec make(real x, real y, real z)
{
    return vec{x, y, z};
}

static __device__ inline vec add(vec a, vec b)
{
    return vec{a.x + b.x, a.y + b.y, a.z + b.z};
}

static __device__ inline vec sub(vec a, vec b)
{
    return vec{a.x - b.x, a.y - b.y, a.z - b.z};
}

static __device__ inline vec scale(real s, vec a)
{
    return vec{s * a.x, s * a.y, s * a.z};
}

/* Returns a + s·b, two roundings a component. */
static __device__ inline vec axpy(vec a, real s, vec b)
{
    return vec{a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/* §1.4 */
static __device__ inline real dot(vec a, vec b)
{
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

static __device__ inline vec cross(vec a, vec b)
{
    return vec{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
               a.x * b.y - a.y * b.x};
}

static __device__ inline real length(vec a)
{
    return root(dot(a, a));
}

static __device__ inline vec min_of(vec a, vec b)
{
    return vec{min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z)};
}

static __device__ inline vec max_of(vec a, vec b)
{
    return vec{max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z)};
}

static __device__ inline bool sane(vec a)
{
    return sane(a.x) && sane(a.y) && sane(a.z);
}

static __device__ inline sym add(sym a, sym b)
{
    return sym{a.xx + b.xx, a.xy + b.xy, a.xz + b.xz,
               a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}

/* Rows of a times b, each (x + y) + z. */
static __device__ inline vec apply(sym a, vec b)
{
    return vec{(a.xx * b.x + a.xy * b.y) + a.xz * b.z,
               (a.xy * b.x + a.yy * b.y) + a.yz * b.z,
               (a.xz * b.x + a.yz * b.y) + a.zz * b.z};
}

#endif
