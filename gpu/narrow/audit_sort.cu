/* SPDX-License-Identifier: Apache-2.0 */
/* Sorts the triangles of stage audit along a Morton curve, builds its tree, and
 * sorts its pairs, on the device. spec/narrow/audit.md §4 */
#include "gpu/narrow/audit.cuh"

extern "C" {
#include "ref/base/keys.h"
}

/* Number of blocks that check positions: few, so that few atomics are needed at
 * the end. */
enum { CHECK_BLOCKS = 256 };

struct audit_levels gpu_audit_levels(int64_t nt)
{
    struct audit_levels l = {};
    int64_t boxes = nt;
    for (;; l.top++) {
        int64_t nodes = (boxes + 3) / 4;
        l.count[l.top] = (int32_t)boxes;
        if (nodes <= 1)
            return l;
        l.at[l.top + 1] = l.at[l.top] + nodes;
        boxes = nodes;
    }
}

/* §4.1: order by middles in binary32. Rounding is harmless, as no result
 * depends on the order. */

/* Maps floats to unsigned integers of the same order. 0 is below all of
 * them. */
static __device__ uint32_t ordered(float a)
{
    uint32_t b;
    memcpy(&b, &a, sizeof b);
    return b >> 31 ? ~b : b | 0x80000000u;
}

static __device__ float of_ordered(uint32_t b)
{
    float a;
    b = b >> 31 ? b & 0x7fffffffu : ~b;
    memcpy(&a, &b, sizeof a);
    return a;
}

/* Thread k checks positions k, k + threads, …. A block reduces its maxima and
 * faults, then makes one atomic for each. */
KERNEL check_kernel(const struct audit &s, int64_t *word)
{
    __shared__ uint32_t high[6];
    uint32_t t = threadIdx.x, own[6] = {0, 0, 0, 0, 0, 0};
    int64_t step = (int64_t)gridDim.x * blockDim.x;
    if (t < 6)
        high[t] = 0;
    __syncthreads();
    for (int64_t k = blockIdx.x * blockDim.x + t; k < s.nv; k += step) {
        if (!sane(s.x[k]))
            audit_bad(word, AUDIT_BAD_PLACE);
        float x[3] = {(float)s.x[k].x, (float)s.x[k].y, (float)s.x[k].z};
        for (int i = 0; i < 3; i++) {
            own[i] = max_of(own[i], ordered(x[i]));
            own[3 + i] = max_of(own[3 + i], ordered(-x[i]));
        }
    }
    for (int i = 0; i < 6; i++)
        atomicMax(&high[i], own[i]);
    __syncthreads();
    if (t < 6)
        atomicMax((uint32_t *)&word[AUDIT_HIGH + t], high[t]);
}

void gpu_audit_check(struct gpu *g, struct audit *s, int64_t *word)
{
    LAUNCH_BLOCKS(g, CHECK_BLOCKS, GPU_BLOCK, check_kernel, *s, word);
}

static __device__ struct audit_span span_of(const struct audit *s, int64_t t)
{
    const int32_t *v = s->tri[t];
    vec a = s->x[v[0]], b = s->x[v[1]], c = s->x[v[2]];
    return audit_span{min_of(min_of(a, b), c), max_of(max_of(a, b), c)};
}

/* Spreads the low 21 bits of b, with two zero bits between neighbours
 * (§4.1). */
static __device__ uint64_t spread(uint64_t b)
{
    b = (b | b << 32) & 0x001f00000000ffffull;
    b = (b | b << 16) & 0x001f0000ff0000ffull;
    b = (b | b << 8) & 0x100f00f00f00f00full;
    b = (b | b << 4) & 0x10c30c30c30c30c3ull;
    return (b | b << 2) & 0x1249249249249249ull;
}

/* Returns the Morton cell, of 2^21 cells over `size`, that holds the middle of
 * lo and hi. */
static __device__ uint64_t cell(real lo, real hi, float from, float size)
{
    float middle = (float)lo * 0.5f + (float)hi * 0.5f;
    float c = size > 0 ? (middle - from) / size * 2097151.0f : 0;
    return c > 0 ? (uint64_t)min_of(c, 2097151.0f) : 0;
}

/* Thread t writes the key of triangle t: group 0 first, then along a Morton
 * curve. */
KERNEL key_kernel(const struct audit &s, struct key *key, const int64_t *word)
{
    ITEM(t, s.nt);
    struct key k = {0, 0, t};
    if (!word[AUDIT_BAD]) {
        float from[3], size = 0;
        for (int i = 0; i < 3; i++) {
            from[i] = -of_ordered((uint32_t)word[AUDIT_HIGH + 3 + i]);
            size = max_of(size,
                          of_ordered((uint32_t)word[AUDIT_HIGH + i]) - from[i]);
        }
        struct audit_span b = span_of(&s, t);
        k.hi = spread(cell(b.lo.x, b.hi.x, from[0], size)) |
               spread(cell(b.lo.y, b.hi.y, from[1], size)) << 1 |
               spread(cell(b.lo.z, b.hi.z, from[2], size)) << 2;
        if (!s.group || s.group[t] != 0)
            k.hi |= (uint64_t)1 << 63;
    }
    key[t] = k;
}

static __device__ void put(const struct audit *s, int64_t at, int32_t b,
                           struct audit_span box)
{
    struct audit_quad *q = &s->node[at + b / 4];
    int j = b % 4;
    q->lo[0][j] = box.lo.x;
    q->lo[1][j] = box.lo.y;
    q->lo[2][j] = box.lo.z;
    q->hi[0][j] = box.hi.x;
    q->hi[1][j] = box.hi.y;
    q->hi[2][j] = box.hi.z;
}

/* Thread k owns place k of the order: it writes order[0][k] and the box
 * there. */
KERNEL leaf_kernel(const struct audit &s, const struct key *key,
                   const int64_t *word)
{
    ITEM(k, s.nt);
    if (word[AUDIT_BAD])
        return;
    s.order[0][k] = (int32_t)key[k].item;
    put(&s, 0, (int32_t)k, span_of(&s, key[k].item));
}

/* Thread b owns box b of a level: it joins up to four boxes of the level
 * below. */
KERNEL level_kernel(const struct audit &s, const struct audit_levels &l,
                    int level, const int64_t *word)
{
    ITEM(b, l.count[level]);
    if (word[AUDIT_BAD])
        return;
    int32_t k = 4 * (int32_t)b, n = l.count[level - 1];
    struct audit_span box = audit_lane(&s, l.at[level - 1], k);
    for (int j = 1; j < 4 && k + j < n; j++) {
        struct audit_span c = audit_lane(&s, l.at[level - 1], k + j);
        box.lo = min_of(box.lo, c.lo);
        box.hi = max_of(box.hi, c.hi);
    }
    put(&s, l.at[level], (int32_t)b, box);
}

void gpu_audit_tree(struct gpu *g, struct audit *s,
                    const struct audit_levels *l, const int64_t *word)
{
    struct key *key =
        (struct key *)gpu_scratch(g, SLOT_STAGE, 2 * s->nt, sizeof *key);
    LAUNCH(g, s->nt, key_kernel, *s, key, word);
    key = gpu_sort(g, s->nt, key, key + s->nt);
    LAUNCH(g, s->nt, leaf_kernel, *s, key, word);
    for (int level = 1; level <= l->top; level++)
        LAUNCH(g, l->count[level], level_kernel, *s, *l, level, word);
}

/* Thread k turns hit k into a sort key. */
KERNEL hit_kernel(int64_t n, const uint64_t *hit, struct key *key)
{
    ITEM(k, n);
    key[k] = {hit[k], 0, 0};
}

/* Thread k writes pair k (§4.4). */
KERNEL pair_kernel(const struct audit &s, const struct key *key)
{
    ITEM(k, s.found);
    s.pair[k][0] = (int32_t)(key[k].hi >> 32);
    s.pair[k][1] = (int32_t)(key[k].hi & 0xffffffffu);
}

void gpu_audit_pairs(struct gpu *g, struct audit *s, const uint64_t *hit)
{
    struct key *key =
        (struct key *)gpu_scratch(g, SLOT_STAGE, 2 * s->found, sizeof *key);
    LAUNCH(g, s->found, hit_kernel, s->found, hit, key);
    key = gpu_sort(g, s->found, key, key + s->found);
    LAUNCH(g, s->found, pair_kernel, *s, key);
}
