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

/* A smoothing: to = x + damping·F (b - A x). */
struct smoothing {
    const vec *b;
    const sym *factor;
    vec *to;
    real *item; /* out: to[p]·b[p]; NULL: not needed */
    real damping;
};

struct smoothing_at {
    vec b;
    sym factor;
};

static __device__ inline struct smoothing_at about(const struct smoothing *s,
                                                   struct place at)
{
    return smoothing_at{s->b[at.p], fetch(s->factor + at.p)};
}

static __device__ inline void arrive(const struct smoothing *s, struct place at,
                                     struct smoothing_at own, vec x, vec y)
{
    vec d = scale(s->damping, solved(own.factor, sub(own.b, y)));
    vec to = add(x, d);
    s->to[at.p] = to;
    if (s->item)
        s->item[at.p] = dot(own.b, to);
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

/* The fine residual, in x, restricted to a coarse particle. */
static __device__ inline vec restricted(const struct level *f, struct place at)
{
    vec sum = make(0, 0, 0);
    UNROLL
    for (int k = 0; k < 9; k++) {
        int di = k % 3 - 1, dj = k / 3 - 1;
        int x = 2 * at.i + di, y = 2 * at.j + dj, p = x + f->g.m * y;
        if (within(f->g, x, y))
            sum =
                axpy(sum, R(0.25) * (real)part_of(f->rule[p], di, dj), f->x[p]);
    }
    return sum;
}

/* Restricts to the right-hand side of coarse particle p, and smooths p for the
 * first time. */
static __device__ inline void restrict_at(const struct level *f,
                                          const struct level *c,
                                          struct place at, real damping)
{
    vec sum = restricted(f, at);
    c->b[at.p] = sum;
    c->y[at.p] = scale(damping, solved(c->factor[at.p], sum));
}

/* A source of x (gpu/solve/edges.cuh): y of the fine grid plus the interpolated
 * correction of the coarse grid. */
struct raised {
    const vec *y, *coarse;
    int32_t m;                   /* particles of the coarse grid along i */
    const uint8_t *rule, *fixed; /* fixed: NULL: all free */
};

/* What `raised` reads at a particle (i, j): y, its rule, and the corrections of
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
    x.here = s->y[at.p];
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
    return raised{f->y, c->x, c->g.m, f->rule, f->fixed};
}

/* The smoothing after the correction. */
static __host__ __device__ inline struct smoothing
smoothing_of(const struct level *l, real damping)
{
    return smoothing{l->b, l->factor, l->x, NULL, damping};
}

/* The residual before the correction. */
static __host__ __device__ inline struct left left_of(const struct level *l)
{
    return left{l->b, l->fixed, l->x};
}

#endif
