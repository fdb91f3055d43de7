/* SPDX-License-Identifier: Apache-2.0 */
/* A spring's 3 × 3 block in 64 bits, for the smoothing of multigrid.
 * spec/cloth/blocks.md §5 */
#ifndef REF_PACKED_H
#define REF_PACKED_H

#include "ref/base/wide.h"

/* The block is size·e eᵀ + all·I. One component of e is 1/2, the others are in
 * [-1/2, 1/2]. way: bits 0 and 1 are the axis of the component 1/2; then follow
 * the next two components, 15 bits each. both: the upper halves, as binary32,
 * of size (lower 16 bits) and of all (upper 16 bits). */
struct packed {
    uint32_t way, both;
};

enum { PACKED_HALF = 1 << 14, PACKED_MOST = (1 << 15) - 1 };

/* §5: returns t in [-1/2, 1/2] as an integer: the number of steps of 2^-15 from
 * -1/2. For t outside, and for NaN, returns the integer of t = 0. */
static inline uint32_t packed_steps(real t)
{
    if (!(t >= R(-0.5) && t <= R(0.5)))
        return PACKED_HALF;
    uint32_t m = (uint32_t)(int32_t)(t * 32768 + R(16384.5));
    return m < PACKED_MOST ? m : (uint32_t)PACKED_MOST;
}

/* Returns the upper 16 bits of a ≥ 0 as a binary32, with a capped at
 * 0x1.fep127. */
static inline uint32_t packed_upper(real a)
{
    float f = (float)real_min(a, R(0x1.fep127));
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits >> 16;
}

/* Returns the upper 16 bits of a binary32 that is at least a and near it. The
 * lower 16 bits of a number are cut off where it is negative, else they count
 * as one more. 0 for NaN. */
static inline uint32_t packed_above(real a)
{
    real most = R(0x1.fep127), size = real_min(real_abs(a), most);
    float f = (float)size;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    if (a > 0)
        return (bits + ((real)f < size) + 0xffff) >> 16;
    return a < 0 ? (bits - ((real)f > size)) >> 16 | 0x8000 : 0;
}

static inline float packed_lower(uint32_t upper)
{
    float f;
    upper <<= 16;
    memcpy(&f, &upper, sizeof f);
    return f;
}

/* Returns the packed block of c u uᵀ + b I, u of length 1. A c that is negative
 * or NaN counts as 0, as does a b that is NaN. */
static inline struct packed packed_make(real c, real b, vec u)
{
    const real of[5] = {u.x, u.y, u.z, u.x, u.y};
    real x = real_abs(u.x), y = real_abs(u.y), z = real_abs(u.z);
    int k = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    real size = 4 * c * (of[k] * of[k]);
    uint32_t p = packed_steps(R(0.5) * of[k + 1] / of[k]);
    uint32_t q = packed_steps(R(0.5) * of[k + 2] / of[k]);
    struct packed t = {(uint32_t)k | p << 2 | q << 17,
                       (size > 0 ? packed_upper(size) : 0) | packed_above(b)
                                                                 << 16};
    return t;
}

/* The numbers that a packed block encodes; exact in either precision. */
struct packed_parts {
    real size, all;
    vec e;
};

static inline struct packed_parts packed_open(struct packed t)
{
    real p = (real)(int32_t)(t.way >> 2 & PACKED_MOST) * R(0x1p-15) - R(0.5);
    real q = (real)(int32_t)(t.way >> 17) * R(0x1p-15) - R(0.5);
    uint32_t k = t.way & 3;
    struct packed_parts a = {(real)packed_lower(t.both & 0xffff),
                             (real)packed_lower(t.both >> 16),
                             k == 0   ? vec_make(R(0.5), p, q)
                             : k == 1 ? vec_make(q, R(0.5), p)
                                      : vec_make(p, q, R(0.5))};
    return a;
}

/* Returns the product of the block with d. */
static inline vec packed_apply(struct packed_parts a, vec d)
{
    return vec_axpy(vec_scale(a.all, d), a.size * vec_dot(a.e, d), a.e);
}

#endif
