/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of a multigrid cycle at one particle. Several kernels use
 * them. spec/solve/multigrid.md §2, §4 */
#ifndef GPU_SMOOTH_CUH
#define GPU_SMOOTH_CUH

#include "gpu/solve/coarsen.cuh"
#include "gpu/solve/edges.cuh"
#include "gpu/solve/level.cuh"

static __device__ inline bool idle(const int32_t *go)
{
    return go && !*go;
}

static __host__ __device__ inline edges<sym> edges_of(const struct level *l)
{
    return edges<sym>{l->g, l->mass, l->extra, l->excess, l->block};
}

/* A half-step of smoothing: d = keep·d + gain·F (b - A x), to = x + d. */
struct half {
    const vec *b;
    const sym *factor;
    const vec *d;     /* NULL: 0 */
    vec *to, *next_d; /* next_d: out: the new d; NULL: not needed */
    real *item;       /* out: to[p]·b[p]; NULL: not needed */
    real keep, gain;
};

struct half_at {
    vec b, d;
    sym factor;
};

static __device__ inline struct half_at about(const struct half *h,
                                              struct place at)
{
    vec d = h->d ? h->d[at.p] : make(0, 0, 0);
    return half_at{h->b[at.p], d, fetch(h->factor + at.p)};
}

static __device__ inline void arrive(const struct half *h, struct place at,
                                     struct half_at own, vec x, vec y)
{
    vec d = scale(h->gain, solved(own.factor, sub(own.b, y)));
    if (h->d)
        d = axpy(d, h->keep, own.d);
    if (h->next_d)
        h->next_d[at.p] = d;
    vec to = add(x, d);
    h->to[at.p] = to;
    if (h->item)
        h->item[at.p] = dot(own.b, to);
}

/* The residual: to = b - A x, 0 where fixed. */
struct left {
    const vec *b;
    const uint8_t *fixed; /* NULL: all free */
    vec *to;
};

struct left_at {
    vec b;
    bool fixed;
};

static __device__ inline struct left_at about(const struct left *l,
                                              struct place at)
{
    return left_at{l->b[at.p], l->fixed && l->fixed[at.p]};
}

static __device__ inline void arrive(const struct left *l, struct place at,
                                     struct left_at own, vec x, vec y)
{
    (void)x;
    l->to[at.p] = own.fixed ? make(0, 0, 0) : sub(own.b, y);
}

/* Restricts the fine residual y to the right-hand side of coarse particle p.
 * Does the first half-step of p too, unless `first` is 0, as for the coarsest
 * grid. */
static __device__ inline void restrict_at(const struct level *f,
                                          const struct level *c,
                                          struct place at, real first)
{
    vec sum = make(0, 0, 0);
    UNROLL
    for (int k = 0; k < 9; k++) {
        int di = k % 3 - 1, dj = k / 3 - 1;
        int x = 2 * at.i + di, y = 2 * at.j + dj, p = x + f->g.m * y;
        if (within(f->g, x, y))
            sum =
                axpy(sum, R(0.25) * (real)part_of(f->rule[p], di, dj), f->y[p]);
    }
    c->b[at.p] = sum;
    if (first != 0)
        c->y[at.p] = scale(first, solved(c->factor[at.p], sum));
}

/* A source of x (gpu/solve/edges.cuh): x of the fine grid plus the interpolated
 * correction of the coarse grid. */
struct raised {
    const vec *x, *coarse;
    int32_t m;                   /* particles of the coarse grid along i */
    const uint8_t *rule, *fixed; /* fixed: NULL: all free */
};

/* What `raised` reads at a particle (i, j): x, its rule, and the corrections of
 * the four coarse particles around. Corner k is ((i + k % 2) / 2, (j + k / 2) /
 * 2). */
struct raised_parts {
    vec here, corner[4];
    int rule; /* -1 where fixed */
};

static __device__ inline struct raised_parts take(const struct raised *s,
                                                  struct place at)
{
    struct raised_parts x;
    x.here = s->x[at.p];
    x.rule = s->fixed && s->fixed[at.p] ? -1 : s->rule[at.p];
    UNROLL
    for (int k = 0; k < 4; k++)
        x.corner[k] =
            s->coarse[(at.i + k % 2) / 2 + s->m * ((at.j + k / 2) / 2)];
    return x;
}

static __device__ inline vec made(const struct raised *s, struct raised_parts x,
                                  struct place at)
{
    (void)s;
    vec sum = make(0, 0, 0);
    if (x.rule < 0)
        return x.here;
    UNROLL
    for (int k = 0; k < 4; k++) {
        int right = k % 2, up = k / 2;
        if ((right && at.i % 2 == 0) || (up && at.j % 2 == 0))
            continue; /* the same coarse particle as the corner before */
        int part = part_of(x.rule, at.i - 2 * ((at.i + right) / 2),
                           at.j - 2 * ((at.j + up) / 2));
        sum = axpy(sum, R(0.25) * (real)part, x.corner[k]);
    }
    return add(x.here, sum);
}

static __host__ __device__ inline struct raised
raised_from(const struct level *c, const struct level *f)
{
    return raised{f->x, c->x, c->g.m, f->rule, f->fixed};
}

/* The first and the second half-step after the correction. */
static __host__ __device__ inline struct half half_one(const struct level *l,
                                                       struct weights w)
{
    return half{l->b, l->factor, NULL, l->y, l->d, NULL, 0, w.first};
}

static __host__ __device__ inline struct half half_two(const struct level *l,
                                                       struct weights w)
{
    return half{l->b, l->factor, l->d, l->x, NULL, NULL, w.keep, w.second};
}

/* The second half-step before the correction, after the opening has left the
 * first one in y; and the residual after it. */
static __host__ __device__ inline struct half half_down(const struct level *l,
                                                        struct weights w)
{
    return half{l->b, l->factor, l->y, l->x, NULL, NULL, w.keep, w.second};
}

static __host__ __device__ inline struct left left_after(const struct level *l)
{
    return left{l->b, l->fixed, l->y};
}

#endif
