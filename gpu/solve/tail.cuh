/* SPDX-License-Identifier: Apache-2.0 */
/* The small grids of a cycle, in one kernel of one cluster that keeps them in
 * shared memory. With a kernel for each pass launches would take longer than
 * the passes, and reading from the L2 cache longer than from shared memory.
 * spec/solve/multigrid.md */
#ifndef GPU_TAIL_CUH
#define GPU_TAIL_CUH

#include "gpu/solve/patch_row.cuh"
#include "gpu/solve/smooth.cuh"

/* TAIL_LEVELS: the most grids. TAIL_REPLICATED: a grid of at most so many
 * particles is computed whole by each rank if it fits, as barriers of a block
 * are faster.
 */
#ifdef __CUDACC__
enum { TAIL_BLOCK = 512, TAIL_LEVELS = 16, TAIL_REPLICATED = 200 };
#else
enum { TAIL_BLOCK = 64, TAIL_LEVELS = 16, TAIL_REPLICATED = 30 };
#endif

struct tail {
    int levels; /* the last is the coarsest */
    struct patch patch[TAIL_LEVELS];
    struct coarsest coarsest;
    int32_t rules; /* of all grids but the coarsest */
    int32_t ruled; /* place of a word: whether any rule is not 0 */
    int32_t dense; /* place of the inverse of the coarsest's operator */
    real damping;
    struct level fine; /* the grid before the first, whose residual is in x */
    bool raises; /* the correction is added to fine.y; else it goes to x */
    vec *x;
    const int32_t *go;
};

static __device__ inline int32_t *ruled(const struct tail *s)
{
    return (int32_t *)(cluster_shared() + s->ruled);
}

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

/* Starts the copies of a rank's coefficients of the grids but the coarsest,
 * which has none: those of the first, of the second and of all others in a
 * group each. A warp copies a stream: the blocks of one direction, the factors
 * or the excess. */
static __device__ inline void fetch_patches(const struct tail *s)
{
    enum { STREAMS = STENCIL + 2 };
    int grids = s->levels - 1, groups = 0;
    for (int e = rank_thread(); e < STENCIL * grids; e += rank_threads()) {
        const struct patch *l = &s->patch[e / STENCIL];
        int o = e % STENCIL;
        edges_at(l->table)[o] = edge_in(l, run_of(l), o);
    }
    for (int e = rank_thread() / WARP; e < STREAMS * grids;
         e += rank_threads() / WARP) {
        const struct patch *l = &s->patch[e / STREAMS];
        struct run r = run_of(l);
        int o = e % STREAMS;
        for (; groups < min_of(e / STREAMS, 2); groups++)
            copies_group();
        fetch_stream(o < STENCIL    ? blocks_of(l, r, o)
                     : o == STENCIL ? factors_of(l, r)
                                    : excess_of(l, r));
    }
    for (; groups < 2; groups++)
        copies_group();
}

/* Copies the rules of all grids, which are adjacent in memory, and tells
 * whether any is not 0. */
static __device__ inline void fetch_rules(const struct tail *s)
{
    enum { AT_ONCE = 6 };
    bool any = false;
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
            any |= rule[k];
        }
    }
    if (any)
        atomicAdd(ruled(s), 1);
}

/* Restricts the residual of the fine grid to all particles of the first grid
 * within reach. It goes to y, until the factors are there. */
static __device__ inline void fetch_vectors(const struct tail *s)
{
    const struct patch *l = &s->patch[0];
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        vec b = restricted(&s->fine, at);
        put_slot(l->y, at.p - r.low, b);
        if (owns(r, at.p))
            put_slot(l->x, at.p - r.first, b);
    }
}

/* The first smoothing of the first grid. */
static __device__ inline void open_first(const struct tail *s)
{
    const struct patch *l = &s->patch[0];
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        int k = at.p - r.low;
        sym factor = fetch(syms(factors_of(l, r).at) + k);
        vec b = slot_at(l->y, k);
        put_slot(l->y, k, scale(s->damping, solved(factor, b)));
    }
    cluster_sync_shared(true);
}

/* Waits for all ranks that have particles of this grid. */
static __device__ inline void patch_sync(const struct patch *l)
{
    cluster_sync_shared(l->replicated);
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

/* The residual of the finer grid, restricted to a particle of the coarser one.
 */
template <bool RULED>
static __device__ inline vec restricted(const struct patch *f, struct place at)
{
    vec sum = make(0, 0, 0), left[9];
    int rule[9];
    UNROLL
    for (int e = 0; e < 9; e++) {
        int i = min_of(max_of(2 * at.i + e % 3 - 1, 0), f->g.m - 1);
        int j = min_of(max_of(2 * at.j + e / 3 - 1, 0), f->g.n - 1);
        rule[e] = RULED ? rules_of(f)[i + f->g.m * j] : 0;
        left[e] = owned(f, f->left, i + f->g.m * j);
    }
    UNROLL
    for (int e = 0; e < 9; e++) {
        int di = e % 3 - 1, dj = e / 3 - 1;
        real part = R(0.25) * (real)part_of(rule[e], di, dj);
        if (within(f->g, 2 * at.i + di, 2 * at.j + dj))
            sum = axpy(sum, part, left[e]);
    }
    return sum;
}

/* As restrict_at; y is computed of all particles within reach. */
template <bool RULED>
static __device__ inline void
restrict_patch(const struct patch *f, const struct patch *l, real damping)
{
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        vec sum = restricted<RULED>(f, at);
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
template <bool RULED>
static __device__ inline void prolong_patch(const struct patch *l,
                                            const struct patch *c)
{
    struct run r = run_of(l);
    EACH_WITHIN(r, at)
    {
        struct raised_parts x;
        int own = at.p - r.low;
        x.here = slot_at(l->y, own);
        x.rule = RULED ? rules_of(l)[at.p] : 0;
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

/* Adds the correction to y of the fine grid. */
static __device__ inline void raise_fine(const struct tail *s)
{
    const struct patch *c = &s->patch[0];
    EACH_OF_GROUP(p, s->fine.count)
    {
        struct place at = place_of(s->fine.g, p);
        struct raised_parts x;
        x.here = s->fine.y[p];
        x.rule = s->fine.fixed && s->fine.fixed[p] ? -1 : s->fine.rule[p];
        UNROLL
        for (int k = 0; k < 4; k++) {
            int i = (at.i + k % 2) / 2, j = (at.j + k / 2) / 2;
            x.corner[k] = owned(c, c->x, i + c->g.m * j);
        }
        s->fine.y[p] = made((const struct raised *)NULL, x, at);
    }
    cluster_sync_shared(false); /* no rank ends while others read from it */
}

/* Starts all copies from global memory and waits for those of the first grid.
 */
static __device__ inline void fetch_all(const struct tail *s)
{
    if (rank_thread() == 0)
        *ruled(s) = 0;
    fetch_patches(s);
    fetch_coarsest(&s->coarsest, s->dense);
    copies_group();
    cluster_sync_shared(true); /* ruled is 0 */
    fetch_rules(s);
    fetch_vectors(s);
    if (s->levels > 1)
        copies_end<2>();
    else
        copies_end<0>();
    cluster_sync_shared(true);
    if (s->levels > 1)
        open_first(s);
}

/* The cycle. RULED: whether any rule is not 0. */
template <bool RULED> static __device__ inline void cycle(const struct tail *s)
{
    int last = s->levels - 1;
    for (int k = 0; k < last; k++) {
        find_left(&s->patch[k], k == 0 && last > 1);
        restrict_patch<RULED>(&s->patch[k], &s->patch[k + 1],
                              k + 1 < last ? s->damping : 0);
    }
    vec *to = s->raises ? NULL : s->x;
    solve_coarsest(s, &s->patch[last], last ? NULL : to);
    for (int k = last - 1; k >= 0; k--) {
        prolong_patch<RULED>(&s->patch[k], &s->patch[k + 1]);
        smooth_up(s, &s->patch[k], k ? NULL : to);
    }
    if (s->raises)
        raise_fine(s);
}

/* One cluster. All ranks come to every barrier, whether they have work or not.
 * No rank writes to another: what a grid is restricted to and interpolated from
 * is read from its owner, which does not change it again. */
KERNEL tail_kernel(const struct tail &s)
{
    if (idle(s.go))
        return;
    fetch_all(&s);
    if (*ruled(&s))
        cycle<true>(&s);
    else
        cycle<false>(&s);
}

/* Lays out the levels from `first` on as patches, those from `replicated` on
 * whole in each rank. Returns the bytes of shared memory of a rank. */
static int64_t lay_tail(struct tail *s, const struct level *l, int levels,
                        int first, int replicated, int ranks)
{
    int64_t at = 0, n = 3 * (int64_t)l[levels - 1].count, rules = 0;
    s->levels = levels - first;
    for (int k = first; k < levels; k++) {
        struct patch *p = &s->patch[k - first];
        *p = patch_of(&l[k], k >= replicated ? 1 : ranks);
        at = lay_patch(p, at, k == levels - 1);
    }
    for (int k = 0; k < s->levels - 1; k++) {
        s->patch[k].rules = (int32_t)(at + rules);
        rules += s->patch[k].count;
    }
    s->rules = (int32_t)rules;
    at += (rules + 15) / 16 * 16;
    s->ruled = (int32_t)at;
    at += 16;
    s->dense = (int32_t)at;
    return at + n * DENSE * (int)sizeof(double);
}

/* Lays out the tail from `first` on for so many ranks, with as many grids whole
 * as fit. Returns the bytes of shared memory of a rank. */
static int64_t fit_ranks(struct tail *s, const struct level *l, int levels,
                         int first, int ranks, int64_t room)
{
    int replicated = levels - 1;
    int64_t bytes = 0;
    while (replicated > first && l[replicated - 1].count <= TAIL_REPLICATED)
        replicated--;
    for (; replicated < levels; replicated++) {
        bytes = lay_tail(s, l, levels, first, replicated, ranks);
        if (bytes <= room)
            break;
    }
    return bytes;
}

/* Finds the finest grid, *first ≥ 1, from which on all grids fit, with the
 * fewest ranks that have a thread for each lane of their rows, or more if it
 * takes more to fit. Lays the grids out. Returns the bytes of shared memory of
 * a rank. */
static int64_t fit_tail(struct tail *s, const struct level *l, int levels,
                        int *first, int *ranks, const struct gpu *g)
{
    for (*first = 1; *first < levels - 1; ++*first) {
        int64_t count = l[*first].count;
        if (levels - *first > TAIL_LEVELS || count > 1 << 16)
            continue;
        *ranks = ranks_for(count, TAIL_BLOCK / ROW_LANES, g->ranks);
        for (;; *ranks = ranks_for(2 * *ranks, 1, g->ranks)) {
            int64_t bytes = fit_ranks(s, l, levels, *first, *ranks, g->room);
            if (bytes <= g->room)
                return bytes;
            if (*ranks == g->ranks)
                break;
        }
    }
    *ranks = 1;
    return lay_tail(s, l, levels, *first, levels - 1, 1);
}

#endif
