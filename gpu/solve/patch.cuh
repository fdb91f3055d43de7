/* SPDX-License-Identifier: Apache-2.0 */
/* A patch: a small grid in the shared memory of a thread-block cluster. Each
 * rank (block) owns a run of consecutive particles, and keeps copies of x and y
 * of other ranks' particles that its own particles read.
 * spec/solve/multigrid.md */
#ifndef GPU_PATCH_CUH
#define GPU_PATCH_CUH

#include "gpu/base/cluster.cuh"
#include "gpu/solve/level.cuh"

/* A grid, and the byte offsets at which its streams begin in the shared memory
 * of every rank. */
struct patch {
    struct grid g;
    int32_t count, share; /* particles of the grid, and of a rank */
    int32_t reach;        /* the largest |q - p| where row q reads x of p */
    int32_t far;          /* how many ranks to each side such rows lie in */
    int64_t inverse; /* p · inverse / 2^32 is p / share, without division */
    int64_t across;  /* p · across / 2^32 is p / m */
    bool alone;      /* rank 0 owns all particles */
    int32_t table;   /* offset of struct edge [STENCIL] */
    int32_t rules;   /* offset of the rules of all particles */
    /* Offsets of the blocks of edge o that start at the rank's particles, or at
     * earlier particles and end at the rank's. */
    int32_t edge[STENCIL];
    int32_t factor, excess; /* offsets of [share] */
    int32_t x, y;           /* offsets; of its particles and all within reach */
    int32_t b;              /* offset of [share] */
    const sym *block_from, *factor_from, *excess_from;
    const uint8_t *rule;
};

/* A direction of edges in shared memory: (di, dj); the step in particle
 * numbers; and the offsets of two blocks: of the edge that ends at the rank's
 * first particle (even if there is none), and of the edge that starts there. */
struct alignas(16) edge {
    int16_t di, dj;
    int32_t step, in, out;
};

/* The run of a rank: its first particle, the number of its particles, and the
 * first particle whose x the rank has; and constants that a row of the product
 * needs. */
struct run {
    int first, own, low;
    int table;
    struct grid g;
    int64_t across;
};

/* Steps in particle numbers from the start to the end of edge o; 0 if no
 * particle of the grid has an edge o. */
static __host__ __device__ inline int edge_step(struct grid g, int o)
{
    int step = toward_i<STENCIL>(o) + g.m * toward_j<STENCIL>(o);
    return step > 0 ? step : 0;
}

/* Returns the number of blocks of edge o that a rank keeps. */
static __host__ __device__ inline int edge_size(const struct patch *l, int o)
{
    int size = l->share + edge_step(l->g, o);
    return size < l->count ? size : l->count;
}

static __device__ inline int low_of(const struct patch *l, int rank)
{
    return max_of(rank * l->share - l->reach, 0);
}

static __device__ inline struct run run_of(const struct patch *l)
{
    int rank = group_rank(), first = min_of(rank * l->share, l->count);
    int own = min_of(l->share, l->count - first);
    return run{first, own, low_of(l, rank), l->table, l->g, l->across};
}

static __device__ inline struct place place_in(struct run r, int p)
{
    int j = (int)(p * r.across >> 32);
    return place{p, p - j * r.g.m, j};
}

/* Return the stream at byte `at` of the rank's shared memory. */
static __device__ inline sym *syms(int at)
{
    return (sym *)(cluster_shared() + at);
}

static __device__ inline vec *vecs(int at)
{
    return (vec *)(cluster_shared() + at);
}

static __device__ inline struct edge *edges_at(int at)
{
    return (struct edge *)(cluster_shared() + at);
}

static __device__ inline uint8_t *rules_of(const struct patch *l)
{
    return (uint8_t *)(cluster_shared() + l->rules);
}

/* Returns how many blocks of edge o the rank keeps of particles before its own.
 */
static __device__ inline int edge_before(const struct patch *l, struct run r,
                                         int o)
{
    return min_of(edge_step(l->g, o), r.first);
}

/* A part of a grid's coefficients that a rank copies: n blocks from `from` on,
 * to byte `at` of its shared memory; both have the same offset from a multiple
 * of 16. Stream o is edge o, or the factors, or the excess. */
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
    int before = edge_before(l, r, o);
    return stream_at(l->block_from + (int64_t)o * l->count + (r.first - before),
                     r.own + before, l->edge[o]);
}

static __device__ inline struct edge edge_in(const struct patch *l,
                                             struct run r, int o)
{
    int di = toward_i<STENCIL>(o), dj = toward_j<STENCIL>(o);
    int step = di + r.g.m * dj, size = (int)sizeof(sym);
    int out = blocks_of(l, r, o).at + edge_before(l, r, o) * size;
    return edge{(int16_t)di, (int16_t)dj, step, out - step * size, out};
}

/* A loop in which the threads of a rank take turns at the particles of its run.
 */
#define EACH_OF(r, at)                                                         \
    for (struct place at = place_in(r, (r).first + rank_thread());             \
         at.p < (r).first + (r).own; at = place_in(r, at.p + rank_threads()))

/* Writes y of a particle to all ranks that read it. */
static __device__ inline void spread(const struct patch *l, int to, int p,
                                     vec value)
{
    int rank = group_rank(), end = min_of(rank + l->far, group_ranks() - 1);
    for (int r = max_of(rank - l->far, 0); r <= end; r++) {
        int low = low_of(l, r), high = (r + 1) * l->share + l->reach;
        if (r == rank)
            vecs(to)[p - low] = value;
        else if (p >= low && p < high)
            cluster_at(vecs(to), r)[p - low] = value;
    }
}

/* Reads x or y of a particle from the rank that owns it. */
static __device__ inline vec owned(const struct patch *l, int from, int p)
{
    int rank = (int)(p * l->inverse >> 32);
    return cluster_at(vecs(from), rank)[p - low_of(l, rank)];
}

/* Returns the bytes that a stream of n blocks takes at any offset within 16
 * bytes. */
static int64_t stream_size(int64_t n)
{
    return (n * (int)sizeof(sym) + 8 + 15) / 16 * 16;
}

/* Lays out the streams of a patch from byte `at` of shared memory on. Returns
 * where they end. last: this is the coarsest grid, which keeps no edges. */
static int64_t lay_patch(struct patch *l, int64_t at, bool last)
{
    int64_t share = l->share, wide = share + 2 * l->reach;
    wide = wide < l->count ? wide : l->count;
    for (int o = 0; o < STENCIL && !last; o++) {
        l->edge[o] = (int32_t)at;
        at += stream_size(edge_size(l, o));
    }
    int64_t size[] = {
        stream_size(share),       stream_size(share),
        wide * (int)sizeof(vec),  wide * (int)sizeof(vec),
        share * (int)sizeof(vec), STENCIL * (int)sizeof(struct edge)};
    int32_t *place[] = {&l->factor, &l->excess, &l->x, &l->y, &l->b, &l->table};
    for (int k = 0; k < 6; k++) {
        *place[k] = (int32_t)at;
        at += (size[k] + 15) / 16 * 16;
    }
    return at;
}

/* Returns the patch of a level for a number of ranks, not laid out yet. */
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
