/* SPDX-License-Identifier: Apache-2.0 */
/* A symmetric matrix stored as the edges of a grid, and one row of its product
 * with a vector (SpMV). An edge links two particles by a 3 × 3 block, which is
 * a spring's or a coarse grid's. spec/solve/product.md §1,
 * spec/solve/multigrid.md §3
 */
#ifndef GPU_EDGES_CUH
#define GPU_EDGES_CUH

#include "gpu/base/cluster.cuh"
#include "gpu/base/packed.cuh"
#include "gpu/solve/grid.cuh"

extern "C" {
#include "ref/solve/product.h"
}

/* Returns the part of a row that belongs to no edge, from mass or from excess.
 * Adding 0 turns -0 into +0. */
static __device__ inline vec own(real mass, vec x)
{
    return add(scale(mass, x), make(0, 0, 0));
}

static __device__ inline vec own(sym excess, vec x)
{
    return add(apply(excess, x), make(0, 0, 0));
}

/* Returns row p of the compressed diagonals times x. */
static __device__ inline vec cdf_row(const struct product *s,
                                     const struct cdf *c, struct place at)
{
    struct grid g = {s->m, s->n};
    vec here = s->x[at.p], y = own(s->mass[at.p], here);
    if (s->n_extra)
        y = add(y, apply(s->extra[at.p], here));
    UNROLL
    for (int k = 1; k < DIAGONALS; k++) {
        /* In each direction the backward diagonal comes before the forward one,
         * §1. */
        int diagonal = k % 2 ? k + 1 : k - 1, sign = k % 2 ? -1 : 1;
        int o = (k - 1) / 2;
        if (!within(g, at.i + sign * forward_i(o), at.j + sign * forward_j(o)))
            continue;
        const mat *a = s->cdf + (c->start[diagonal] + at.p);
        vec d = sub(s->x[at.p + c->offset[diagonal]], here);
        y = add(y, make(dot(a->x, d), dot(a->y, d), dot(a->z, d)));
    }
    return y;
}

/* The diagonal is made of mass and extra, or of excess. B is the type in which
 * an edge's block is stored: sym, struct packed or struct rate. */
template <class B> struct edges {
    struct grid g;
    const real *mass;  /* NULL: the diagonal is made of excess */
    const sym *extra;  /* NULL: none */
    const sym *excess; /* NULL: the diagonal is made of mass */
    const B *block;    /* [SPRINGS or STENCIL · m·n] */
};

/* A source of x is a type with two functions, so that a product can read a
 * vector that is not in memory: made(&source, take(&source, place), place)
 * returns x at the place. take only reads memory, which nothing may write
 * meanwhile, and so may run early to hide latency. This source is a stream in
 * memory. */
struct plain {
    const vec *x;
};

static __device__ inline vec take(const struct plain *s, struct place at)
{
    return s->x[at.p];
}

static __device__ inline vec made(const struct plain *s, vec x, struct place at)
{
    (void)s;
    (void)at;
    return x;
}

template <class X>
static __device__ inline auto value_at(const X *s, struct place at)
{
    return made(s, take(s, at), at);
}

static __device__ inline struct place beside(struct grid g, struct place at,
                                             int di, int dj)
{
    return place{at.p + di + g.m * dj, at.i + di, at.j + dj};
}

/* The part of A x that belongs to no edge: from mass and extra, or from excess.
 */
struct base {
    real mass;
    sym extra; /* extra, or the excess */
};

template <int EDGES, class B>
static __device__ inline struct base base_of(const struct edges<B> *t, int p)
{
    struct base b = {};
    if (EDGES == STENCIL) {
        b.extra = fetch(t->excess + p);
        return b;
    }
    b.mass = t->mass[p];
    if (t->extra)
        b.extra = fetch(t->extra + p);
    return b;
}

template <int EDGES, class B>
static __device__ inline vec own_part(const struct edges<B> *t, struct base b,
                                      vec x)
{
    if (EDGES == STENCIL)
        return own(b.extra, x);
    vec y = own(b.mass, x);
    return t->extra ? add(y, apply(b.extra, x)) : y;
}

/* Starts with y of the first of LANES lanes, APART from one to the next, then
 * subtracts and adds the terms of each lane, lane after lane. The last lane has
 * the result. All threads of the warp must call it. */
template <int LANES, int APART, int EACH>
static __device__ inline vec add_by_lanes(vec y, const vec less[EACH],
                                          const vec plus[EACH], int lane)
{
    UNROLL
    for (int step = 0; step < LANES; step++) {
        vec below = step ? lane_below<APART>(y) : y;
        if (lane != step)
            continue;
        y = below;
        UNROLL
        for (int k = 0; k < EACH; k++)
            y = add(sub(y, less[k]), plus[k]);
    }
    return y;
}

/* Row p of A x by LANES adjacent lanes of a warp, all of which must call it:
 * the diagonal part, then for each direction the edge that ends at p and the
 * edge that starts there. Each lane has consecutive directions and reads all
 * their blocks before it needs the first, as small grids are bound by memory
 * latency. The last lane has the result; *here: x[p]. */
template <int EDGES, int LANES, class B, class X>
static __device__ inline vec gathered(const struct edges<B> *t, const X *x,
                                      struct place at, int lane, vec *here)
{
    enum { EACH = EDGES / LANES };
    B before[EACH], after[EACH];
    vec from[EACH], to[EACH], own = *here = value_at(x, at);
    bool ends[EACH], starts[EACH];
    UNROLL
    for (int k = 0; k < EACH; k++) {
        int o = lane * EACH + k;
        int di = toward_i<EDGES>(o), dj = toward_j<EDGES>(o);
        const B *b = t->block + (int64_t)o * t->g.m * t->g.n;
        struct place p = beside(t->g, at, -di, -dj);
        struct place q = beside(t->g, at, di, dj);
        ends[k] = within(t->g, p.i, p.j);
        starts[k] = within(t->g, q.i, q.j);
        p = ends[k] ? p : at;
        q = starts[k] ? q : at;
        before[k] = fetch(b + p.p);
        after[k] = fetch(b + at.p);
        from[k] = value_at(x, p);
        to[k] = value_at(x, q);
    }
    vec y = make(0, 0, 0);
    if (lane == 0)
        y = own_part<EDGES>(t, base_of<EDGES>(t, at.p), own);
    UNROLL
    for (int k = 0; k < EACH; k++) {
        vec none = make(0, 0, 0); /* adding 0 changes no y, as y is never -0 */
        from[k] = ends[k] ? apply(before[k], sub(from[k], own)) : none;
        to[k] = starts[k] ? apply(after[k], sub(own, to[k])) : none;
    }
    return add_by_lanes<LANES, 1, EACH>(y, from, to, lane);
}

#endif
