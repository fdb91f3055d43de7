/* SPDX-License-Identifier: Apache-2.0 */
/* A cycle's small grids in one kernel of one team, which keeps them in its
 * shared memory: a kernel a pass takes longer to start than to run, and a pass
 * from the L2 cache longer than one from there. spec/14_multigrid.md */
#ifndef GPU_TAIL_CUH
#define GPU_TAIL_CUH

#include "gpu/patch.cuh"
#include "gpu/smooth.cuh"

/* TAIL_LEVELS: most grids; TAIL_ALONE: particles from which down a grid is
 * rank 0's alone, if there is room: its barriers are quicker; TAIL_UNITED:
 * particles of a rank, with fewer each has a thread for every direction. */
#ifdef __CUDACC__
enum { TAIL_BLOCK = 512, TAIL_LEVELS = 16, TAIL_ALONE = 200, TAIL_UNITED = 72 };
#else
enum { TAIL_BLOCK = 64, TAIL_LEVELS = 16, TAIL_ALONE = 30, TAIL_UNITED = 12 };
#endif

struct tail {
    int levels; /* the last is the coarsest */
    struct patch patch[TAIL_LEVELS];
    struct coarsest coarsest;
    int32_t pull;           /* place of the pulls of a united grid */
    int32_t dense, unknown; /* of the coarsest's factor, of its unknowns */
    struct weights w;
    const vec *b, *y; /* the first grid's right-hand side and half-step */
    vec *x;           /* the result there */
    const int32_t *go;
};

/* Of a grid's coefficients a rank's, without waiting for them: a warp takes
 * block o of all, two more the others. */
static __device__ inline void fetch_patch(const struct patch *l)
{
    enum { EACH = sizeof(sym) / sizeof(real2), WARP = 32 };
    struct run r = run_of(l);
    int t = rank_thread();
    if (t < STENCIL)
        ((int32_t *)(team_room() + l->table))[t] = l->tie[t];
    for (int o = t / WARP; o < STENCIL + 2 && r.own > 0;
         o += rank_threads() / WARP) {
        bool tie = o < STENCIL;
        int before = tie ? least(tie_step(l->g, o), r.first) : 0;
        const sym *start = tie ? l->block_from + (int64_t)o * l->count
                           : o == STENCIL ? l->factor_from
                                          : l->excess_from;
        int place = tie ? l->tie[o] : o == STENCIL ? l->factor : l->excess;
        const real2 *from = (const real2 *)(start + (r.first - before));
        real2 *to = (real2 *)syms(place);
#ifdef __CUDACC__
#pragma unroll 4
#endif
        for (int k = t % WARP; k < EACH * (r.own + before); k += WARP)
            copy_ahead(to + k, from + k);
    }
}

/* What the first grid starts from. */
static __device__ inline void fetch_vectors(const struct tail *s)
{
    const struct patch *l = &s->patch[0];
    struct run r = run_of(l);
    int high = least(r.first + r.own + l->reach, l->count);
    int n = s->levels > 1 ? 3 * (high - r.low) : 0; /* else no half-step */
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

/* ---- a row of A x ---- */

/* The pulls of tie o, which is (di, dj), that ends at a particle and of the one
 * that starts there, 0 where there is none: to add or subtract that changes no
 * y, which is never -0. x: at the particle. */
static __device__ inline void pulls_of(struct run r, struct place at, int o,
                                       int di, int dj, const vec *x, vec f[2])
{
    int step = di + r.g.m * dj;
    int k = at.p - r.first + least(most(step, 0), r.first);
    bool ends = within(r.g, at.i - di, at.j - dj);
    bool starts = within(r.g, at.i + di, at.j + dj);
    const sym *block = syms(((const int32_t *)(team_room() + r.table))[o]);
    sym in = fetch(block + (ends ? k - step : k)), out = fetch(block + k);
    vec here = *x, from = x[ends ? -step : 0], to = x[starts ? step : 0];
    vec none = make(0, 0, 0);
    f[0] = ends ? apply(in, sub(from, here)) : none;
    f[1] = starts ? apply(out, sub(here, to)) : none;
}

/* Adds the pulls of ties from di = FROM to 2 of row dj. */
template <int FROM>
static __device__ inline void pull_ties(struct run r, struct place at, int dj,
                                        const vec *x, vec *y)
{
    UNROLL
    for (int di = FROM; di <= 2; di++) {
        vec f[2];
        pulls_of(r, at, 5 * dj + di - 1, di, dj, x, f);
        *y = add(sub(*y, f[0]), f[1]);
    }
}

/* What the ties of a particle add to y, x at byte `from` of the room. One copy
 * of it is all that the kernel has: what it runs through is soon cached. */
static __device__ __noinline__ vec pulled(struct run r, struct place at,
                                          int from, vec y)
{
    const vec *x = vecs(from) + (at.p - r.low);
    pull_ties<1>(r, at, 0, x, &y);
#ifdef __CUDACC__
#pragma unroll 1
#endif
    for (int dj = 1; dj <= 2; dj++)
        pull_ties<-2>(r, at, dj, x, &y);
    return y;
}

/* The pulls of all particles of a rank, by a thread a direction: [2·STENCIL]
 * [own] at byte `to`. */
static __device__ __noinline__ void pull_united(struct run r, int from, int to)
{
    for (int u = rank_thread(); u < STENCIL * r.own; u += rank_threads()) {
        int o = u / r.own, k = u - o * r.own;
        struct place at = place_of(r.g, r.first + k);
        vec f[2];
        pulls_of(r, at, o, toward_i<STENCIL>(o), toward_j<STENCIL>(o),
                 vecs(from) + (at.p - r.low), f);
        vecs(to)[2 * o * r.own + k] = f[0];
        vecs(to)[(2 * o + 1) * r.own + k] = f[1];
    }
    __syncthreads();
}

/* A x at a particle; of a united grid pull_united has run. */
static __device__ inline vec patch_row(const struct tail *s,
                                       const struct patch *l, struct run r,
                                       struct place at, int from)
{
    int k = at.p - r.first;
    vec y = own(fetch(syms(l->excess) + k), vecs(from)[at.p - r.low]);
    if (!l->united)
        return pulled(r, at, from, y);
    const vec *pull = vecs(s->pull) + k;
    UNROLL
    for (int o = 0; o < STENCIL; o++)
        y = add(sub(y, pull[2 * o * r.own]), pull[(2 * o + 1) * r.own]);
    return y;
}

/* gain·F (b - A x) */
static __device__ inline vec patch_step(const struct tail *s,
                                        const struct patch *l, struct run r,
                                        struct place at, int from, real gain)
{
    vec y = patch_row(s, l, r, at, from);
    int k = at.p - r.first;
    sym factor = fetch(syms(l->factor) + k);
    return scale(gain, solved(factor, sub(vecs(l->b)[k], y)));
}

/* ---- the passes ---- */

/* The second half-step down, the first being y, and what is left, in y. */
static __device__ inline void smooth_down(const struct tail *s,
                                          const struct patch *l)
{
    struct run r = run_of(l);
    if (l->united)
        pull_united(r, l->y, s->pull);
    EACH_OF(r, at)
    {
        vec d = patch_step(s, l, r, at, l->y, s->w.second);
        vec here = vecs(l->y)[at.p - r.low];
        spread(l, l->x, at.p, add(here, axpy(d, s->w.keep, here)));
    }
    copies_end<0>(); /* of the grids to come */
    team_sync(l->alone);
    if (l->united)
        pull_united(r, l->x, s->pull);
    EACH_OF(r, at)
    {
        vec y = patch_row(s, l, r, at, l->x);
        vecs(l->y)[at.p - r.low] = sub(vecs(l->b)[at.p - r.first], y);
    }
    team_sync(l->alone);
}

/* As restrict_at. */
static __device__ inline void restrict_patch(const struct patch *f,
                                             const struct patch *l, real first)
{
    struct run r = run_of(l);
    EACH_OF(r, at)
    {
        vec sum = make(0, 0, 0), y[9];
        int rule[9];
        UNROLL
        for (int e = 0; e < 9; e++) {
            int i = least(most(2 * at.i + e % 3 - 1, 0), f->g.m - 1);
            int j = least(most(2 * at.j + e / 3 - 1, 0), f->g.n - 1);
            rule[e] = f->rule[i + f->g.m * j];
            y[e] = owned(f, f->y, i + f->g.m * j);
        }
        UNROLL
        for (int e = 0; e < 9; e++) {
            int di = e % 3 - 1, dj = e / 3 - 1;
            if (within(f->g, 2 * at.i + di, 2 * at.j + dj))
                sum = axpy(sum, R(0.25) * (real)part_of(rule[e], di, dj), y[e]);
        }
        int k = at.p - r.first;
        vecs(l->b)[k] = sum;
        if (first != 0) {
            sym factor = fetch(syms(l->factor) + k);
            spread(l, l->y, at.p, scale(first, solved(factor, sum)));
        }
    }
    team_sync(l->alone);
}

/* x with the correction of the coarser grid c. */
static __device__ inline void prolong_patch(const struct patch *l,
                                            const struct patch *c)
{
    struct run r = run_of(l);
    EACH_OF(r, at)
    {
        struct raised_parts x;
        x.here = vecs(l->x)[at.p - r.low];
        x.rule = l->rule[at.p];
        UNROLL
        for (int k = 0; k < 4; k++) {
            int i = (at.i + k % 2) / 2, j = (at.j + k / 2) / 2;
            x.corner[k] = owned(c, c->x, i + c->g.m * j);
        }
        spread(l, l->x, at.p, made((const struct raised *)NULL, x, at));
    }
    team_sync(l->alone);
}

/* Both half-steps up; the result to `to`, or to x where that is NULL. */
static __device__ inline void smooth_up(const struct tail *s,
                                        const struct patch *l, vec *to)
{
    struct run r = run_of(l);
    if (l->united)
        pull_united(r, l->x, s->pull);
    EACH_OF(r, at)
    {
        vec d = patch_step(s, l, r, at, l->x, s->w.first);
        vecs(l->d)[at.p - r.first] = d;
        spread(l, l->y, at.p, add(vecs(l->x)[at.p - r.low], d));
    }
    team_sync(l->alone);
    if (l->united)
        pull_united(r, l->y, s->pull);
    EACH_OF(r, at)
    {
        vec d = patch_step(s, l, r, at, l->y, s->w.second);
        d = axpy(d, s->w.keep, vecs(l->d)[at.p - r.first]);
        vec x = add(vecs(l->y)[at.p - r.low], d);
        if (to)
            to[at.p] = x;
        else
            vecs(l->x)[at.p - r.low] = x;
    }
}

/* All that is read of global memory but rules; the first grid's is there when
 * it returns. */
static __device__ inline void fetch_all(const struct tail *s)
{
    int last = s->levels - 1;
    if (last > 0)
        fetch_patch(&s->patch[0]);
    copies_group();
    for (int k = 1; k < last; k++)
        fetch_patch(&s->patch[k]);
    copies_group();
    fetch_vectors(s);
    fetch_coarsest(&s->coarsest, (double *)(team_room() + s->dense));
    copies_end<1>();
    team_sync(false);
}

/* One team, its ranks together at every barrier, whoever has work between.
 * What one rank writes for another lies between two barriers of the team; of
 * a grid that is rank 0's alone the others own nothing. */
static __global__ void __launch_bounds__(TAIL_BLOCK, 1)
    tail_kernel(const __grid_constant__ struct tail s)
{
    if (idle(s.go))
        return;
    int last = s.levels - 1;
    const struct patch *end = &s.patch[last];
    fetch_all(&s);
    for (int k = 0; k < last; k++) {
        smooth_down(&s, &s.patch[k]);
        restrict_patch(&s.patch[k], &s.patch[k + 1],
                       k + 1 < last ? s.w.first : 0);
    }
    solve_coarsest(&s.coarsest, (const double *)(team_room() + s.dense),
                   (double *)(team_room() + s.unknown), vecs(end->b),
                   last || team_rank() ? vecs(end->x) : s.x);
    for (int k = last - 1; k >= 0; k--) {
        team_sync(s.patch[k].alone);
        prolong_patch(&s.patch[k], &s.patch[k + 1]);
        smooth_up(&s, &s.patch[k], k ? NULL : s.x);
    }
}

/* ---- on the host ---- */

/* Lays levels from `first` on out as patches, those from `alone` on of one
 * rank: the bytes of a room. */
static int64_t lay_tail(struct tail *s, const struct level *l, int levels,
                        int first, int alone, int ranks)
{
    int64_t at = 0, n = 3 * (int64_t)l[levels - 1].count;
    s->levels = levels - first;
    int64_t united = 0;
    for (int k = first; k < levels; k++) {
        struct patch *p = &s->patch[k - first];
        *p = patch_of(&l[k], k >= alone ? 1 : ranks);
        p->united = k < levels - 1 && p->share <= TAIL_UNITED;
        if (p->united && united < p->share)
            united = p->share;
        at = lay_patch(p, at, k == levels - 1);
    }
    s->dense = (int32_t)at;
    at += (n * dense_pitch((int)n) + 1) / 2 * 2 * (int)sizeof(double);
    s->unknown = (int32_t)at;
    at += (n + 1) / 2 * 2 * (int)sizeof(double);
    s->pull = (int32_t)at;
    return at + 2 * STENCIL * united * (int)sizeof(vec);
}

/* The largest grid from which on all of them fit, and how they lie: *first,
 * ≥ 1; the bytes of a room. */
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
