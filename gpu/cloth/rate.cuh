/* SPDX-License-Identifier: Apache-2.0 */
/* The vector and the edges of a product that reads rates in place of blocks.
 * gpu/cloth/rate.h */
#ifndef GPU_RATE_CUH
#define GPU_RATE_CUH

#include "gpu/cloth/rate.h"
#include "gpu/solve/edges.cuh"

/* The item x and the position `at` of a particle. */
struct alignas(2 * sizeof(real)) footing {
    vec x, at;
};

static __device__ inline vec x_of(vec x)
{
    return x;
}

static __device__ inline vec x_of(struct footing f)
{
    return f.x;
}

/* A source of x (see take and made of the product), with the positions. */
template <class X> struct grounded {
    X x;
    const vec *at;
};

template <class V> struct grounded_parts {
    V x;
    vec at;
};

template <class X>
static __device__ inline auto take(const struct grounded<X> *s, struct place at)
    -> struct grounded_parts<decltype(take(&s->x, at))> {
    return {take(&s->x, at), s->at[at.p]};
}

template <class X, class V>
static __device__ inline struct footing
made(const struct grounded<X> *s, struct grounded_parts<V> x, struct place at)
{
    return footing{made(&s->x, x.x, at), x.at};
}

static __device__ inline struct rate fetch_once(const struct rate *r)
{
#ifdef __CUDA_ARCH__
    return rate{__ldcs(&r->across), __ldcs(&r->along), __ldcs(&r->inverse)};
#else
    return *r;
#endif
}

/* From the edges of a direction to those of the next. */
template <class B> static __device__ inline int64_t stride_of(struct grid g)
{
    return (int64_t)g.m * g.n;
}

template <> __device__ inline int64_t stride_of<struct rate>(struct grid g)
{
    return RATES_PITCH((int64_t)g.m * g.n);
}

/* The block of a rate, with the roundings of spec/cloth/blocks.md §1. */
static __device__ inline sym block_of(struct rate r, vec d)
{
    vec u = scale(r.inverse, d), w = scale(r.along, u);
    return sym{w.x * u.x + r.across, w.x * u.y, w.x * u.z,
               w.y * u.y + r.across, w.y * u.z, w.z * u.z + r.across};
}

/* B (x_p - x_q) of the edge from p to q. */
template <class B> static __device__ inline vec edge_pull(B b, vec p, vec q)
{
    return apply(b, sub(p, q));
}

static __device__ inline vec edge_pull(struct rate r, struct footing p,
                                       struct footing q)
{
    return apply(block_of(r, sub(q.at, p.at)), sub(p.x, q.x));
}

#endif
