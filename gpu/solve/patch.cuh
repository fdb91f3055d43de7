/* SPDX-License-Identifier: Apache-2.0 */
/* A small grid that lies in the rooms of a team: each rank owns a run of its
 * particles and has copies of what these read of others.
 * spec/solve/multigrid.md */
#ifndef GPU_PATCH_CUH
#define GPU_PATCH_CUH

#include "gpu/base/team.cuh"
#include "gpu/solve/level.cuh"

/* A grid and where its streams begin in every room. */
struct patch {
    struct grid g;
    int32_t count, share; /* of particles, all, and those of a rank */
    int32_t reach;        /* the most steps from p to who reads its x */
    int32_t far;          /* ranks to each side that they may belong to */
    int64_t inverse;      /* p · inverse / 2^32 is p / share */
    int64_t across;       /* likewise p / m */
    bool alone;           /* all are rank 0's */
    int32_t shift;        /* 2^shift threads share a row of the product */
    int32_t table;        /* place of struct edge [STENCIL] */
    int32_t rules;        /* place of the rules of all particles */
    /* block o of the rank's particles and of those before that lead to them */
    int32_t edge[STENCIL];
    int32_t factor, excess; /* [share] */
    int32_t x, y;           /* of its particles and all within reach */
    int32_t b, d;           /* [share] */
    const sym *block_from, *factor_from, *excess_from;
    const uint8_t *rule;
};

/* Edge o of a grid in a room: (di, dj), how many particles further that is, and
 * where the blocks of the edges lie that end at the rank's first particle, were
 * there one, and that start there. */
struct alignas(16) edge {
    int16_t di, dj;
    int32_t step, in, out;
};

/* A rank's run of a grid: its first particle, how many, and the first one whose
 * x it has; and what a row of the product needs besides. */
struct run {
    int first, own, low;
    int table;
    struct grid g;
    int64_t across;
};

/* Steps from a particle to the end of its edge o; 0 where it never has one. */
static __host__ __device__ inline int tie_step(struct grid g, int o)
{
    int step = toward_i<STENCIL>(o) + g.m * toward_j<STENCIL>(o);
    return step > 0 ? step : 0;
}

/* Particles in the room's stream of edge o. */
static __host__ __device__ inline int tie_size(const struct patch *l, int o)
{
    int size = l->share + tie_step(l->g, o);
    return size < l->count ? size : l->count;
}

static __device__ inline int low_of(const struct patch *l, int rank)
{
    return most(rank * l->share - l->reach, 0);
}

static __device__ inline struct run run_of(const struct patch *l)
{
    int rank = team_rank(), first = least(rank * l->share, l->count);
    int own = least(l->share, l->count - first);
    return run{first, own, low_of(l, rank), l->table, l->g, l->across};
}

static __device__ inline struct place place_in(struct run r, int p)
{
    int j = (int)(p * r.across >> 32);
    return place{p, p - j * r.g.m, j};
}

/* The streams of the room. */
static __device__ inline sym *syms(int at)
{
    return (sym *)(team_room() + at);
}

static __device__ inline vec *vecs(int at)
{
    return (vec *)(team_room() + at);
}

static __device__ inline struct edge *ties_at(int at)
{
    return (struct edge *)(team_room() + at);
}

static __device__ inline uint8_t *rules_of(const struct patch *l)
{
    return (uint8_t *)(team_room() + l->rules);
}

/* Blocks of edge o that a rank has of particles before its own. */
static __device__ inline int tie_before(const struct patch *l, struct run r,
                                        int o)
{
    return least(tie_step(l->g, o), r.first);
}

/* Of a grid's coefficients what a rank has: n from `from` on, at byte `at` of
 * its room, which is as far from a multiple of 16. Stream o is edge o, or the
 * factors, or the excess. */
struct stream {
    const sym *from;
    int n, at;
};

static __device__ inline struct stream stream_at(const sym *from, int n, int at)
{
    return stream{from, n, at + (int)((uintptr_t)from % 16)};
}

static __device__ inline struct stream factors_of(const struct patch *l,
                                                  struct run r)
{
    return stream_at(l->factor_from + r.first, r.own, l->factor);
}

static __device__ inline struct stream excess_of(const struct patch *l,
                                                 struct run r)
{
    return stream_at(l->excess_from + r.first, r.own, l->excess);
}

static __device__ inline struct stream blocks_of(const struct patch *l,
                                                 struct run r, int o)
{
    int before = tie_before(l, r, o);
    return stream_at(l->block_from + (int64_t)o * l->count + (r.first - before),
                     r.own + before, l->edge[o]);
}

static __device__ inline struct edge tie_in(const struct patch *l, struct run r,
                                            int o)
{
    int di = toward_i<STENCIL>(o), dj = toward_j<STENCIL>(o);
    int step = di + r.g.m * dj, size = (int)sizeof(sym);
    int out = blocks_of(l, r, o).at + tie_before(l, r, o) * size;
    return edge{(int16_t)di, (int16_t)dj, step, out - step * size, out};
}

/* All threads of a rank take turns at the particles of its run. */
#define EACH_OF(r, at)                                                         \
    for (struct place at = place_in(r, (r).first + rank_thread());             \
         at.p < (r).first + (r).own; at = place_in(r, at.p + rank_threads()))

/* x or y of a particle to all ranks that read it. */
static __device__ inline void spread(const struct patch *l, int to, int p,
                                     vec value)
{
    int rank = team_rank(), end = least(rank + l->far, team_ranks() - 1);
    for (int r = most(rank - l->far, 0); r <= end; r++) {
        int low = low_of(l, r), high = (r + 1) * l->share + l->reach;
        if (r == rank)
            vecs(to)[p - low] = value;
        else if (p >= low && p < high)
            team_at(vecs(to), r)[p - low] = value;
    }
}

/* x or y of a particle from the rank that owns it. */
static __device__ inline vec owned(const struct patch *l, int from, int p)
{
    int rank = (int)(p * l->inverse >> 32);
    return team_at(vecs(from), rank)[p - low_of(l, rank)];
}

/* The bytes of a stream of n, wherever in 16 it begins. */
static int64_t stream_size(int64_t n)
{
    return (n * (int)sizeof(sym) + 8 + 15) / 16 * 16;
}

/* Gives a grid its share and its places from byte `at` of the room on: returns
 * where they end. last: it is the coarsest, which has no edges. */
static int64_t lay_patch(struct patch *l, int64_t at, bool last)
{
    int64_t share = l->share, wide = share + 2 * l->reach;
    wide = wide < l->count ? wide : l->count;
    for (int o = 0; o < STENCIL && !last; o++) {
        l->edge[o] = (int32_t)at;
        at += stream_size(tie_size(l, o));
    }
    int64_t size[] = {stream_size(share),
                      stream_size(share),
                      wide * (int)sizeof(vec),
                      wide * (int)sizeof(vec),
                      share * (int)sizeof(vec),
                      share * (int)sizeof(vec),
                      STENCIL * (int)sizeof(struct edge)};
    int32_t *place[] = {&l->factor, &l->excess, &l->x,    &l->y,
                        &l->b,      &l->d,      &l->table};
    for (int k = 0; k < 7; k++) {
        *place[k] = (int32_t)at;
        at += (size[k] + 15) / 16 * 16;
    }
    return at;
}

/* A level as a patch of `ranks` ranks. */
static struct patch patch_of(const struct level *l, int ranks)
{
    struct patch p = {};
    p.g = l->g;
    p.count = l->count;
    p.alone = ranks == 1;
    p.share = (l->count + ranks - 1) / ranks;
    p.reach = 2 * l->g.m + 2;
    p.far = ranks == 1 ? 0 : (p.reach + p.share - 1) / p.share;
    p.inverse = ((INT64_C(1) << 32) + p.share - 1) / p.share;
    p.across = ((INT64_C(1) << 32) + l->g.m - 1) / l->g.m;
    p.block_from = l->block;
    p.factor_from = l->factor;
    p.excess_from = l->excess;
    p.rule = l->rule;
    return p;
}

#endif
