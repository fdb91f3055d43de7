/* SPDX-License-Identifier: Apache-2.0 */
/* The small grids of a cycle, in one kernel of one cluster that keeps them in
 * shared memory. With a kernel for each pass launches would take longer than
 * the passes, and reading from the L2 cache longer than from shared memory.
 * spec/solve/multigrid.md */
#ifndef GPU_TAIL_CUH
#define GPU_TAIL_CUH

#include "gpu/solve/patch_row.cuh"
#include "gpu/solve/smooth.cuh"

/* TAIL_LEVELS: the most grids. TAIL_ALONE: a grid of at most so many particles
 * belongs to rank 0 alone if it fits, as barriers of a block are faster. */
#ifdef __CUDACC__
enum { TAIL_BLOCK = 512, TAIL_LEVELS = 16, TAIL_ALONE = 200 };
#else
enum { TAIL_BLOCK = 64, TAIL_LEVELS = 16, TAIL_ALONE = 30 };
#endif

struct tail {
    int levels; /* the last is the coarsest */
    struct patch patch[TAIL_LEVELS];
    struct coarsest coarsest;
    int32_t rules; /* of all grids but the coarsest */
    int32_t dense; /* place of the coarsest's factor */
    real damping;
    const vec *b, *y; /* the first grid's right-hand side, and y smoothed */
    vec *x;           /* the result there */
    const int32_t *go;
};

/* A warp copies a stream to its place; parts that are not aligned to 16 bytes
 * come first and last. */
static __device__ inline void fetch_stream(struct stream s)
{
    enum { HALF = 8, QUAD = 16 };
    struct alignas(QUAD) quad {
        double half[2];
    };
    int lane = rank_thread() % WARP, bytes = s.n * (int)sizeof(sym);
    int head = s.at % QUAD, quads = (bytes - head) / QUAD;
    const char *from = (const char *)s.from;
    char *to = cluster_shared() + s.at;
    if (lane == 0 && head && bytes)
        copy_ahead((double *)to, (const double *)from);
    if (lane == 1 && (bytes - head) % QUAD)
        copy_ahead((double *)(to + bytes - HALF),
                   (const double *)(from + bytes - HALF));
#ifdef __CUDACC__
#pragma unroll 4
#endif
    for (int k = lane; k < quads; k += WARP)
        copy_ahead((quad *)(to + head) + k, (const quad *)(from + head) + k);
}

/* Starts the copies of a rank's coefficients of a grid: a warp copies the
 * blocks of one direction, two more warps the factors and the excess. */
static __device__ inline void fetch_patch(const struct patch *l)
{
    struct run r = run_of(l);
    int t = rank_thread();
    if (t < STENCIL)
        edges_at(l->table)[t] = edge_in(l, r, t);
    for (int o = t / WARP; o < STENCIL + 2; o += rank_threads() / WARP)
        fetch_stream(o < STENCIL    ? blocks_of(l, r, o)
                     : o == STENCIL ? factors_of(l, r)
                                    : excess_of(l, r));
}

/* Copies the rules of all grids, which are adjacent in memory. */
static __device__ inline void fetch_rules(const struct tail *s)
{
    enum { AT_ONCE = 12 };
    const uint8_t *from = s->patch[0].rule;
    uint8_t *to = rules_of(&s->patch[0]), rule[AT_ONCE];
    for (int first = rank_thread(); first < s->rules;
         first += AT_ONCE * rank_threads()) {
        UNROLL
        for (int k = 0; k < AT_ONCE; k++) {
            int e = first + k * rank_threads();
            rule[k] = e < s->rules ? from[e] : 0;
        }
        UNROLL
        for (int k = 0; k < AT_ONCE; k++) {
            int e = first + k * rank_threads();
            if (e < s->rules)
                to[e] = rule[k];
        }
    }
}

/* Copies the right-hand side and y of the first grid. */
static __device__ inline void fetch_vectors(const struct tail *s)
{
    const struct patch *l = &s->patch[0];
    struct run r = run_of(l);
    int high = min_of(r.first + r.own + l->reach, l->count);
    int n = s->levels > 1 ? 3 * (high - r.low)
                          : 0; /* otherwise nothing is smoothed */
    const real *y = (const real *)(s->y + r.low);
    const real *b = (const real *)(s->b + r.first);
    UNROLL
    for (int k = 0; k < 3; k++) {
        int e = rank_thread() + k * rank_threads();
        if (e < n)
            ((real *)vecs(l->y))[e] = y[e];
        if (e < 3 * r.own)
            ((real *)vecs(l->b))[e] = b[e];
    }
    for (int e = rank_thread() + 3 * rank_threads(); e < n; e += rank_threads())
        ((real *)vecs(l->y))[e] = y[e];
    for (int e = rank_thread() + 3 * rank_threads(); e < 3 * r.own;
         e += rank_threads())
        ((real *)vecs(l->b))[e] = b[e];
}

/* The residual after y goes to x. */
static __device__ inline void find_left(const struct patch *l)
{
    struct run r = run_of(l);
    EACH_ROW(item, r)
    {
        struct row w = row_of(r, item);
        vec y = patch_row(l, r, w, l->y);
        if (w.last)
            vecs(l->x)[w.at.p - r.low] = sub(vecs(l->b)[w.at.p - r.first], y);
    }
    copies_end<0>(); /* of the grids to come */
    cluster_sync(l->alone);
}

/* As restrict_at. */
static __device__ inline void
restrict_patch(const struct patch *f, const struct patch *l, real damping)
{
    struct run r = run_of(l);
    EACH_OF(r, at)
    {
        vec sum = make(0, 0, 0), left[9];
        int rule[9];
        UNROLL
        for (int e = 0; e < 9; e++) {
            int i = min_of(max_of(2 * at.i + e % 3 - 1, 0), f->g.m - 1);
            int j = min_of(max_of(2 * at.j + e / 3 - 1, 0), f->g.n - 1);
            rule[e] = rules_of(f)[i + f->g.m * j];
            left[e] = owned(f, f->x, i + f->g.m * j);
        }
        UNROLL
        for (int e = 0; e < 9; e++) {
            int di = e % 3 - 1, dj = e / 3 - 1;
            if (within(f->g, 2 * at.i + di, 2 * at.j + dj))
                sum = axpy(sum, R(0.25) * (real)part_of(rule[e], di, dj),
                           left[e]);
        }
        int k = at.p - r.first;
        vecs(l->b)[k] = sum;
        if (damping != 0) {
            sym factor = fetch(syms(factors_of(l, r).at) + k);
            spread(l, l->y, at.p, scale(damping, solved(factor, sum)));
        }
    }
    cluster_sync(l->alone);
}

/* Adds the correction of the coarser grid c to y. */
static __device__ inline void prolong_patch(const struct patch *l,
                                            const struct patch *c)
{
    struct run r = run_of(l);
    EACH_OF(r, at)
    {
        struct raised_parts x;
        x.here = vecs(l->y)[at.p - r.low];
        x.rule = rules_of(l)[at.p];
        UNROLL
        for (int k = 0; k < 4; k++) {
            int i = (at.i + k % 2) / 2, j = (at.j + k / 2) / 2;
            x.corner[k] = owned(c, c->x, i + c->g.m * j);
        }
        spread(l, l->y, at.p, made((const struct raised *)NULL, x, at));
    }
    cluster_sync(l->alone);
}

/* Smooths y. The result goes to `to`, or to x if `to` is NULL. */
static __device__ inline void smooth_up(const struct tail *s,
                                        const struct patch *l, vec *to)
{
    struct run r = run_of(l);
    EACH_ROW(item, r)
    {
        struct row w = row_of(r, item);
        vec d = patch_step(l, r, w, l->y, s->damping);
        if (w.last) {
            vec x = add(vecs(l->y)[w.at.p - r.low], d);
            (to ? to + w.at.p : vecs(l->x) + (w.at.p - r.low))[0] = x;
        }
    }
}

/* Starts all copies from global memory, and waits for those of the first grid.
 */
static __device__ inline void fetch_all(const struct tail *s)
{
    int last = s->levels - 1;
    if (last > 0)
        fetch_patch(&s->patch[0]);
    copies_group();
    for (int k = 1; k < last; k++)
        fetch_patch(&s->patch[k]);
    copies_group();
    fetch_rules(s);
    fetch_vectors(s);
    fetch_coarsest(&s->coarsest, (double *)(cluster_shared() + s->dense));
    copies_end<1>();
    cluster_sync(false);
}

/* One cluster. All ranks come to every barrier, whether they have work or not.
 * Writes for another rank lie between two barriers of the cluster. In a grid
 * that belongs to rank 0 alone the other ranks own nothing. */
static __global__ void __launch_bounds__(TAIL_BLOCK, 1)
    tail_kernel(const __grid_constant__ struct tail s)
{
    if (idle(s.go))
        return;
    int last = s.levels - 1;
    const struct patch *end = &s.patch[last];
    fetch_all(&s);
    for (int k = 0; k < last; k++) {
        find_left(&s.patch[k]);
        restrict_patch(&s.patch[k], &s.patch[k + 1],
                       k + 1 < last ? s.damping : 0);
    }
    solve_coarsest(&s.coarsest, (const double *)(cluster_shared() + s.dense),
                   vecs(end->b), last || group_rank() ? vecs(end->x) : s.x);
    for (int k = last - 1; k >= 0; k--) {
        cluster_sync(s.patch[k].alone);
        prolong_patch(&s.patch[k], &s.patch[k + 1]);
        smooth_up(&s, &s.patch[k], k ? NULL : s.x);
    }
}

/* Lays out the levels from `first` on as patches, those from `alone` on for one
 * rank. Returns the bytes of shared memory of a rank. */
static int64_t lay_tail(struct tail *s, const struct level *l, int levels,
                        int first, int alone, int ranks)
{
    int64_t at = 0, n = 3 * (int64_t)l[levels - 1].count, rules = 0;
    s->levels = levels - first;
    for (int k = first; k < levels; k++) {
        struct patch *p = &s->patch[k - first];
        *p = patch_of(&l[k], k >= alone ? 1 : ranks);
        at = lay_patch(p, at, k == levels - 1);
    }
    for (int k = 0; k < s->levels - 1; k++) {
        s->patch[k].rules = (int32_t)(at + rules);
        rules += s->patch[k].count;
    }
    s->rules = (int32_t)rules;
    at += (rules + 15) / 16 * 16;
    s->dense = (int32_t)at;
    return at + n * dense_pitch((int)n) * (int)sizeof(double);
}

/* Finds the finest grid, *first ≥ 1, from which on all grids fit, and lays them
 * out. Returns the bytes of shared memory of a rank. */
static int64_t fit_tail(struct tail *s, const struct level *l, int levels,
                        int *first, const struct gpu *g)
{
    for (*first = 1; *first < levels - 1; ++*first) {
        int alone = levels - 1;
        if (levels - *first > TAIL_LEVELS || l[*first].count > 1 << 16)
            continue;
        for (int k = levels - 1; k >= *first && l[k].count <= TAIL_ALONE; k--)
            alone = k;
        for (; alone < levels; alone++) {
            int64_t bytes = lay_tail(s, l, levels, *first, alone, g->ranks);
            if (bytes <= g->room)
                return bytes;
        }
    }
    return lay_tail(s, l, levels, *first, levels - 1, g->ranks);
}

#endif
