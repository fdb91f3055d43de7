/* SPDX-License-Identifier: Apache-2.0 */
/* A block from its rate, and the edge of a product that reads rates in place of
 * blocks. gpu/cloth/rate.h */
#ifndef GPU_RATE_CUH
#define GPU_RATE_CUH

#include "gpu/cloth/rate.h"
#include "gpu/solve/edges.cuh"

static __device__ inline struct rate fetch_once(const struct rate *r)
{
#ifdef __CUDA_ARCH__
    const vec *a = &r->along;
    return rate{__ldcs(&r->across),
                {__ldcs(&a->x), __ldcs(&a->y), __ldcs(&a->z)}};
#else
    return *r;
#endif
}

/* The block of a rate, with the roundings of spec/cloth/blocks.md §1. */
static __device__ inline sym block_of(struct rate r)
{
    vec f = r.along;
    return sym{f.x * f.x + r.across, f.x * f.y, f.x * f.z,
               f.y * f.y + r.across, f.y * f.z, f.z * f.z + r.across};
}

/* B (x_p - x_q) of the edge from p to q. */
template <class B> static __device__ inline vec edge_pull(B b, vec p, vec q)
{
    return apply(b, sub(p, q));
}

static __device__ inline vec edge_pull(struct rate r, vec p, vec q)
{
    return apply(block_of(r), sub(p, q));
}

#endif
