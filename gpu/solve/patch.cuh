/* SPDX-License-Identifier: Apache-2.0 */
/* A patch: a small grid in the shared memory of a thread-block cluster. Each
 * rank (block) owns a run of consecutive particles, whose rows it computes, and
 * keeps y of all particles that these rows read. It computes the y of others
 * itself, as their owners do, so that no rank writes to another.
 * spec/solve/multigrid.md */
#ifndef GPU_PATCH_CUH
#define GPU_PATCH_CUH

#include "gpu/base/cluster.cuh"
#include "gpu/solve/level.cuh"

/* A grid, and the byte offsets at which its streams begin in the shared memory
 * of every rank. */
struct patch {
    struct grid g;
    int32_t count, per_rank;  /* particles of the grid, and of a rank */
    int32_t reach;            /* the largest |q - p| where row q reads y of p */
    uint32_t inverse, across; /* of share and of m, for quotient */
    bool replicated;          /* each rank owns all particles */
    int32_t table;            /* offset of struct edge [STENCIL] */
    int32_t rules;            /* offset of the rules of all particles */
    /* Offsets of the blocks of edge o that start at the rank's particles, or at
     * earlier particles and end at the rank's. */
    int32_t edge[STENCIL];
    int32_t excess, factor; /* of its particles; of all within reach */
    int32_t left;           /* residuals of its particles */
    int32_t x; /* of its particles: right-hand side, then solution */
    int32_t y; /* of all within reach */
    const sym *block_from, *factor_from, *excess_from;
    const uint8_t *rule;
};

/* A vector in shared memory, which one instruction reads or writes. */
struct alignas(16) slot {
    real x, y, z, none;
};

/* A direction of edges in shared memory: (di, dj); the step in particle
 * numbers; and the offsets of two blocks: of the edge that ends at the rank's
 * first particle (even if there is none), and of the edge that starts there. */
struct alignas(16) edge {
    int16_t di, dj;
    int32_t step, in, out;
};

/* The run of a rank: its first particle, the number of its particles, the
 * particles [low, high) whose y it has, and what a row needs to know. */
struct run {
    int first, own, low, high;
    int table;
    struct grid g;
    uint32_t across;
};

/* Returns a / b without division, for a < 2^16; inverse is inverse_of(b). */
static __device__ inline int quotient(int a, uint32_t inverse)
{
    return inverse ? (int)((uint64_t)a * inverse >> 32) : a;
}

static uint32_t inverse_of(int b)
{
    return b > 1 ? (uint32_t)(((INT64_C(1) << 32) + b - 1) / b) : 0;
}

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
    int size = l->per_rank + edge_step(l->g, o);
    return size < l->count ? size : l->count;
}

static __device__ inline struct run run_of(const struct patch *l)
{
    int first =
        l->replicated ? 0 : min_of(group_rank() * l->per_rank, l->count);
    int own = min_of(l->per_rank, l->count - first);
    int low = max_of(first - l->reach, 0);
    int high = own ? min_of(first + own + l->reach, l->count) : low;
    return run{first, own, low, high, l->table, l->g, l->across};
}

static __device__ inline struct place place_in(struct run r, int p)
{
    int j = quotient(p, r.across);
    return place{p, p - j * r.g.m, j};
}

/* Return the stream at byte `at` of the rank's shared memory. */
static __device__ inline sym *syms(int at)
{
    return (sym *)(cluster_shared() + at);
}

static __device__ inline struct slot *slots(int at)
{
    return (struct slot *)(cluster_shared() + at);
}

static __device__ inline vec value_of(struct slot a)
{
    return make(a.x, a.y, a.z);
}

static __device__ inline vec slot_at(int at, int k)
{
    return value_of(slots(at)[k]);
}

static __device__ inline void put_slot(int at, int k, vec a)
{
    slots(at)[k] = slot{a.x, a.y, a.z, 0};
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
    return stream_at(l->factor_from + r.low, r.high - r.low, l->factor);
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

/* A loop in which the threads of a rank take turns at the particles within
 * reach. */
#define EACH_WITHIN(r, at)                                                     \
    for (struct place at = place_in(r, (r).low + rank_thread());               \
         at.p < (r).high; at = place_in(r, at.p + rank_threads()))

static __device__ inline bool owns(struct run r, int p)
{
    return p >= r.first && p < r.first + r.own;
}

/* Reads the residual or x of a particle from the rank that owns it. */
static __device__ inline vec owned(const struct patch *l, int from, int p)
{
    if (l->replicated)
        return slot_at(from, p);
    int rank = quotient(p, l->inverse);
    return value_of(cluster_at(slots(from), rank)[p - rank * l->per_rank]);
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
    int64_t per_rank = l->per_rank, wide = per_rank + 2 * l->reach;
    wide = wide < l->count ? wide : l->count;
    for (int o = 0; o < STENCIL && !last; o++) {
        l->edge[o] = (int32_t)at;
        at += stream_size(edge_size(l, o));
    }
    int64_t slot = (int)sizeof(struct slot);
    int64_t size[] = {
        stream_size(per_rank), stream_size(wide),
        per_rank * slot,       per_rank * slot,
        wide * slot,           STENCIL * (int)sizeof(struct edge)};
    int32_t *place[] = {&l->excess, &l->factor, &l->left,
                        &l->x,      &l->y,      &l->table};
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
    p.replicated = ranks == 1;
    p.per_rank = (l->count + ranks - 1) / ranks;
    p.reach = 2 * l->g.m + 2;
    p.inverse = inverse_of(p.per_rank);
    p.across = inverse_of(l->g.m);
    p.block_from = l->block;
    p.factor_from = l->factor;
    p.excess_from = l->excess;
    p.rule = l->rule;
    return p;
}

#endif
