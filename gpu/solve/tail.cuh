/* SPDX-License-Identifier: Apache-2.0 */
/* The small grids of a cycle, in one kernel of one cluster that keeps them in
 * shared memory. With a kernel for each pass launches would take longer than
 * the passes, and reading from the L2 cache longer than from shared memory.
 * spec/solve/multigrid.md */
#ifndef GPU_TAIL_CUH
#define GPU_TAIL_CUH

#include "gpu/solve/patch_row.cuh"
#include "gpu/solve/smooth.cuh"

/* TAIL_LEVELS: the most grids. TAIL_WHOLE: a grid of at most so many particles
 * is computed whole by each rank if it fits, as barriers of a block are faster.
 */
#ifdef __CUDACC__
enum { TAIL_BLOCK = 1024, TAIL_LEVELS = 16, TAIL_WHOLE = 200 };
#else
enum { TAIL_BLOCK = 64, TAIL_LEVELS = 16, TAIL_WHOLE = 30 };
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
    enum { AT_ONCE = 6 };
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
    for (int p = r.low + rank_thread(); p < r.high; p += rank_threads()) {
        bool own = owns(r, p);
        vec b = s->b[own ? p : r.first];
        if (s->levels > 1) /* otherwise nothing is smoothed */
            put_slot(l->y, p - r.low, s->y[p]);
        if (own)
            put_slot(l->x, p - r.first, b);
    }
}

/* Waits for all ranks that have particles of this grid. */
static __device__ inline void patch_sync(const struct patch *l)
{
    cluster_sync_shared(l->whole);
}

/* The residual after y. later: copies for grids after the next may go on. */
static __device__ inline void find_left(const struct patch *l, bool later)
{
    struct run r = run_of(l);
    EACH_ROW(item, r)
    {
        struct row w = row_of(r, item);
        vec y = patch_row(l, r, w, l->y);
        int at = w.at.p - r.first;
        if (w.last)
            put_slot(l->left, at, sub(slot_at(l->x, at), y));
    }
    if (later)
        copies_end<1>();
    else
        copies_end<0>();
    patch_sync(l);
}

/* As restrict_at; y is computed of all particles within reach. */
static __device__ inline void
restrict_patch(const struct patch *f, const struct patch *l, real damping)
{
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        vec sum = make(0, 0, 0), left[9];
        int rule[9];
        UNROLL
        for (int e = 0; e < 9; e++) {
            int i = min_of(max_of(2 * at.i + e % 3 - 1, 0), f->g.m - 1);
            int j = min_of(max_of(2 * at.j + e / 3 - 1, 0), f->g.n - 1);
            rule[e] = rules_of(f)[i + f->g.m * j];
            left[e] = owned(f, f->left, i + f->g.m * j);
        }
        UNROLL
        for (int e = 0; e < 9; e++) {
            int di = e % 3 - 1, dj = e / 3 - 1;
            if (within(f->g, 2 * at.i + di, 2 * at.j + dj))
                sum = axpy(sum, R(0.25) * (real)part_of(rule[e], di, dj),
                           left[e]);
        }
        if (owns(r, at.p))
            put_slot(l->x, at.p - r.first, sum);
        if (damping != 0) {
            int k = at.p - r.low;
            sym factor = fetch(syms(factors_of(l, r).at) + k);
            put_slot(l->y, k, scale(damping, solved(factor, sum)));
        }
    }
    cluster_sync_shared(true);
}

/* Adds the correction of the coarser grid c to y of all particles within reach.
 */
static __device__ inline void prolong_patch(const struct patch *l,
                                            const struct patch *c)
{
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        struct raised_parts x;
        int own = at.p - r.low;
        x.here = slot_at(l->y, own);
        x.rule = rules_of(l)[at.p];
        UNROLL
        for (int k = 0; k < 4; k++) {
            int i = (at.i + k % 2) / 2, j = (at.j + k / 2) / 2;
            x.corner[k] = owned(c, c->x, i + c->g.m * j);
        }
        put_slot(l->y, own, made((const struct raised *)NULL, x, at));
    }
    cluster_sync_shared(true);
}

/* Smooths y. The result goes to `to`, or to x if `to` is NULL. */
static __device__ inline void smooth_up(const struct tail *s,
                                        const struct patch *l, vec *to)
{
    struct run r = run_of(l);
    EACH_ROW(item, r)
    {
        struct row w = row_of(r, item);
        vec d = patch_step(l, r, w, s->damping);
        if (!w.last)
            continue;
        vec x = add(slot_at(l->y, w.at.p - r.low), d);
        if (to)
            to[w.at.p] = x;
        else
            put_slot(l->x, w.at.p - r.first, x);
    }
    patch_sync(l);
}

/* The solution on the coarsest grid, which each rank has whole. The result goes
 * to `to`, or to x if `to` is NULL. */
static __device__ inline void solve_coarsest(const struct tail *s,
                                             const struct patch *l, vec *to)
{
    int i = rank_thread(), n = 3 * l->count;
    real *b = (real *)slots(l->x);
    real x = i < n ? coarsest_row(&s->coarsest, s->dense, b, i) : 0;
    cluster_sync_shared(true); /* b has been read */
    if (i < n)
        *(to ? (real *)to + i : b + 4 * (i / 3) + i % 3) = x;
    cluster_sync_shared(true);
}

/* Starts all copies from global memory, those of the first grid, of the second
 * and of all others in a group each, and waits for those of the first. */
static __device__ inline void fetch_all(const struct tail *s)
{
    int last = s->levels - 1;
    for (int k = 0; k < last; k++) {
        fetch_patch(&s->patch[k]);
        if (k < 2)
            copies_group();
    }
    for (int k = last; k < 2; k++)
        copies_group();
    fetch_coarsest(&s->coarsest, s->dense);
    copies_group();
    fetch_rules(s);
    fetch_vectors(s);
    if (last > 0)
        copies_end<2>();
    else
        copies_end<0>();
    cluster_sync_shared(true);
}

/* One cluster. All ranks come to every barrier, whether they have work or not.
 * No rank writes to another: what a grid is restricted to and interpolated from
 * is read from its owner, which does not change it again. */
static __global__ void __launch_bounds__(TAIL_BLOCK, 1)
    tail_kernel(const __grid_constant__ struct tail s)
{
    if (idle(s.go))
        return;
    int last = s.levels - 1;
    fetch_all(&s);
    for (int k = 0; k < last; k++) {
        find_left(&s.patch[k], k == 0 && last > 1);
        restrict_patch(&s.patch[k], &s.patch[k + 1],
                       k + 1 < last ? s.damping : 0);
    }
    solve_coarsest(&s, &s.patch[last], last ? NULL : s.x);
    for (int k = last - 1; k >= 0; k--) {
        prolong_patch(&s.patch[k], &s.patch[k + 1]);
        smooth_up(&s, &s.patch[k], k ? NULL : s.x);
    }
}

/* Lays out the levels from `first` on as patches, those from `whole` on whole
 * in each rank. Returns the bytes of shared memory of a rank. */
static int64_t lay_tail(struct tail *s, const struct level *l, int levels,
                        int first, int whole, int ranks)
{
    int64_t at = 0, n = 3 * (int64_t)l[levels - 1].count, rules = 0;
    s->levels = levels - first;
    for (int k = first; k < levels; k++) {
        struct patch *p = &s->patch[k - first];
        *p = patch_of(&l[k], k >= whole ? 1 : ranks);
        at = lay_patch(p, at, k == levels - 1);
    }
    for (int k = 0; k < s->levels - 1; k++) {
        s->patch[k].rules = (int32_t)(at + rules);
        rules += s->patch[k].count;
    }
    s->rules = (int32_t)rules;
    at += (rules + 15) / 16 * 16;
    s->dense = (int32_t)at;
    return at + n * DENSE * (int)sizeof(double);
}

/* Finds the finest grid, *first ≥ 1, from which on all grids fit, and lays them
 * out. Returns the bytes of shared memory of a rank. */
static int64_t fit_tail(struct tail *s, const struct level *l, int levels,
                        int *first, const struct gpu *g)
{
    for (*first = 1; *first < levels - 1; ++*first) {
        int whole = levels - 1;
        if (levels - *first > TAIL_LEVELS || l[*first].count > 1 << 16)
            continue;
        for (int k = levels - 1; k >= *first && l[k].count <= TAIL_WHOLE; k--)
            whole = k;
        for (; whole < levels; whole++) {
            int64_t bytes = lay_tail(s, l, levels, *first, whole, g->ranks);
            if (bytes <= g->room)
                return bytes;
        }
    }
    return lay_tail(s, l, levels, *first, levels - 1, g->ranks);
}

#endif
