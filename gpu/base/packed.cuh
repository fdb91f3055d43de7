/* SPDX-License-Identifier: Apache-2.0 */
/* A spring's block in 64 bits on the device. spec/cloth/blocks.md §5 */
#ifndef GPU_PACKED_CUH
#define GPU_PACKED_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/base/packed.h"
}

static __device__ inline uint32_t steps_of(real t)
{
    if (!(t >= R(-0.5) && t <= R(0.5)))
        return PACKED_HALF;
    return min_of((uint32_t)(int32_t)(t * 32768 + R(16384.5)),
                  (uint32_t)PACKED_MOST);
}

static __device__ inline float float_of(uint32_t bits)
{
    float a;
    memcpy(&a, &bits, sizeof a);
    return a;
}

/* Returns the upper half of the bits of a > 0; 0 for any other a. */
static __device__ inline uint32_t upper_of(real a)
{
    float f = (float)min_of(a, R(0x1.fep127));
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return a > 0 ? bits >> 16 : 0;
}

/* Returns the upper half of a number that is at least a and near a; 0 for NaN.
 */
static __device__ inline uint32_t above_of(real a)
{
    real size = min_of(magnitude(a), R(0x1.fep127));
    float f = (float)size;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    uint32_t up = (bits + ((real)f < size) + 0xffff) >> 16;
    uint32_t down = (bits - ((real)f > size)) >> 16 | 0x8000;
    return a > 0 ? up : a < 0 ? down : 0;
}

/* Returns the packed block of c u uᵀ + b I, u of length 1. */
static __device__ inline struct packed packed_of(real c, real b, vec u)
{
    real x = magnitude(u.x), y = magnitude(u.y), z = magnitude(u.z);
    uint32_t k = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    vec v = k == 0   ? u
            : k == 1 ? make(u.y, u.z, u.x)
                     : make(u.z, u.x, u.y); /* the largest first */
    uint32_t p = steps_of(R(0.5) * v.y / v.x);
    uint32_t q = steps_of(R(0.5) * v.z / v.x);
    return packed{k | p << 2 | q << 17,
                  upper_of(4 * c * (v.x * v.x)) | above_of(b) << 16};
}

/* Returns the number that is m steps of 2^-15 above -1/2. m is put into the
 * lower bits of a number in [1, 2), which needs no conversion. */
static __device__ inline real stepped(uint32_t m)
{
    return (real)(float_of(0x3f800000u | m << 8) - 1.5f);
}

static __device__ inline struct packed_parts opened(struct packed t)
{
    real p = stepped(t.way >> 2 & PACKED_MOST), q = stepped(t.way >> 17);
    uint32_t k = t.way & 3;
    vec e = k == 0   ? make(R(0.5), p, q)
            : k == 1 ? make(q, R(0.5), p)
                     : make(p, q, R(0.5));
    return packed_parts{(real)float_of(t.both << 16),
                        (real)float_of(t.both & 0xffff0000u), e};
}

static __device__ inline vec apply(struct packed t, vec d)
{
    struct packed_parts a = opened(t);
    return axpy(scale(a.all, d), a.size * dot(a.e, d), a.e);
}

/* Read a packed block; fetch_once is for blocks that are not read again soon.
 */
static __device__ inline struct packed fetch(const struct packed *t)
{
#ifdef __CUDA_ARCH__
    uint2 a = *(const uint2 *)t;
    return packed{a.x, a.y};
#else
    return *t;
#endif
}

static __device__ inline struct packed fetch_once(const struct packed *t)
{
#ifdef __CUDA_ARCH__
    uint2 a = __ldcs((const uint2 *)t);
    return packed{a.x, a.y};
#else
    return *t;
#endif
}

#endif
