/* SPDX-License-Identifier: Apache-2.0 */
/* Linearly moving AABBs and their overlap test on the device.
 * spec/broad/refit.md §1, §3, §5 */
#ifndef GPU_BOX_CUH
#define GPU_BOX_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/broad/box.h"
}

/* Types of 8 and 16 bytes for wide loads and stores. Streams begin at multiples
 * of 256 bytes, so an item whose size is a multiple of a type's can be moved in
 * few instructions. */
struct alignas(8) word8 {
    uint32_t a, b;
} __attribute__((may_alias));
struct alignas(16) word16 {
    uint32_t a, b, c, d;
} __attribute__((may_alias));

template <class W, class T> static __device__ inline T fetch_as(const T *p)
{
    enum { WORDS = sizeof(T) / sizeof(W) };
    static_assert(WORDS * sizeof(W) == sizeof(T), "not whole words");
    union {
        W w[WORDS];
        T t;
    } u;
    for (int k = 0; k < WORDS; k++)
        u.w[k] = ((const W *)(const void *)p)[k];
    return u.t;
}

template <class W, class T>
static __device__ inline void put_as(T *p, const T &t)
{
    enum { WORDS = sizeof(T) / sizeof(W) };
    static_assert(WORDS * sizeof(W) == sizeof(T), "not whole words");
    union {
        T t;
        W w[WORDS];
    } u = {t};
    for (int k = 0; k < WORDS; k++)
        ((W *)(void *)p)[k] = u.w[k];
}

/* A box in a still query, one whose x1 is x0: a struct box without its second
 * half, which equals the first (§5). */
struct still_box {
    vec lo, hi;
};

static __device__ inline struct box join(const struct box &a,
                                         const struct box &b)
{
    struct box c = {min_of(a.lo0, b.lo0), max_of(a.hi0, b.hi0),
                    min_of(a.lo1, b.lo1), max_of(a.hi1, b.hi1)};
    return c;
}

static __device__ inline struct still_box join(const struct still_box &a,
                                               const struct still_box &b)
{
    return {min_of(a.lo, b.lo), max_of(a.hi, b.hi)};
}

/* BOX: struct box, or struct still_box in a still query. */

template <class BOX> static __device__ inline BOX fetch_box(const struct box *p)
{
    enum { WIDE = sizeof(BOX) % sizeof(word16) == 0 };
    typedef std::conditional_t<WIDE, word16, word8> word;
    return fetch_as<word>((const BOX *)(const void *)p);
}

template <class BOX>
static __device__ inline BOX vertex_box(const vec *x0, const vec *x1, int32_t v)
{
    if constexpr (std::is_same_v<BOX, struct box>)
        return {x0[v], x0[v], x1[v], x1[v]};
    else
        return {x0[v], x0[v]};
}

template <class BOX>
static __device__ inline BOX face_box(const vec *x0, const vec *x1,
                                      const int32_t *f)
{
    return join(
        join(vertex_box<BOX>(x0, x1, f[0]), vertex_box<BOX>(x0, x1, f[1])),
        vertex_box<BOX>(x0, x1, f[2]));
}

/* Returns the inflated reach r⁺ (§3), which the host passes to kernels. */
static inline real reach_of(real r)
{
    return r * (1 + BOX_REACH * REAL_UNIT);
}

/* The two sides of a box on one axis, at both ends of the step. */
struct sides {
    real lo0, hi0, lo1, hi1;
};

/* The two gaps of two boxes on one axis, each at t = 0 and t = 1. A negative
 * gap means that the boxes are apart (§3). */
struct gaps {
    real g0, g1, h0, h1;
};

static __device__ inline struct gaps between(struct sides a, struct sides b,
                                             real reach)
{
    struct gaps g = {(b.hi0 - a.lo0) + reach, (b.hi1 - a.lo1) + reach,
                     (a.hi0 - b.lo0) + reach, (a.hi1 - b.lo1) + reach};
    return g;
}

/* Whether a gap is negative at both ends of the step. *low becomes the least
 * gap so far. */
static __device__ inline bool apart(struct gaps g, real *low)
{
    *low = min_of(*low, min_of(min_of(g.g0, g.g1), min_of(g.h0, g.h1)));
    return max_of(g.g0, g.g1) < 0 || max_of(g.h0, g.h1) < 0;
}

/* Narrows the bounds of q = (1 - t) / t by a gap that goes from g0 to g1
 * (§3). */
static __device__ inline void bound(real g0, real g1, real *late, real *early)
{
    if (g0 < 0)
        *late = min_of(*late, g1 / -g0);
    else if (g1 < 0)
        *early = max_of(*early, -g1 / g0);
}

static __device__ inline void bound(struct gaps g, real *late, real *early)
{
    bound(g.g0, g.g1, late, early);
    bound(g.h0, g.h1, late, early);
}

/* The overlap test. Returns whether a and b may come within r of each other;
 * reach is reach_of(r). */
static __device__ inline bool meets(const struct box &a, const struct box &b,
                                    real reach)
{
    real low = 0, late = R(INFINITY), early = 0;
    struct gaps x = between({a.lo0.x, a.hi0.x, a.lo1.x, a.hi1.x},
                            {b.lo0.x, b.hi0.x, b.lo1.x, b.hi1.x}, reach);
    if (apart(x, &low))
        return false;
    struct gaps y = between({a.lo0.y, a.hi0.y, a.lo1.y, a.hi1.y},
                            {b.lo0.y, b.hi0.y, b.lo1.y, b.hi1.y}, reach);
    if (apart(y, &low))
        return false;
    struct gaps z = between({a.lo0.z, a.hi0.z, a.lo1.z, a.hi1.z},
                            {b.lo0.z, b.hi0.z, b.lo1.z, b.hi1.z}, reach);
    if (apart(z, &low))
        return false;
    if (!(low < 0))
        return true;
    bound(x, &late, &early);
    bound(y, &late, &early);
    bound(z, &late, &early);
    return !(late * (1 + BOX_LATE * REAL_UNIT) + R(0x1p-100) < early);
}

/* §5: the same test, as no gap changes. */
static __device__ inline bool meets(const struct still_box &a,
                                    const struct still_box &b, real reach)
{
    bool x = ((b.hi.x - a.lo.x) + reach < 0) | ((a.hi.x - b.lo.x) + reach < 0);
    bool y = ((b.hi.y - a.lo.y) + reach < 0) | ((a.hi.y - b.lo.y) + reach < 0);
    bool z = ((b.hi.z - a.lo.z) + reach < 0) | ((a.hi.z - b.lo.z) + reach < 0);
    return !(x | y | z);
}

#endif
