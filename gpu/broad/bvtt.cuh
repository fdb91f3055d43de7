/* SPDX-License-Identifier: Apache-2.0 */
/* The bounding-volume test tree (BVTT) on the device: parents, children and the
 * pass test of node pairs, and the places at which a block of items writes.
 * spec/broad/front.md §1, §2, §4 */
#ifndef GPU_BVTT_CUH
#define GPU_BVTT_CUH

#include "gpu/base/scan.cuh"
#include "gpu/broad/box.cuh"

extern "C" {
#include "ref/broad/bvtt.h"
}

/* A pair of nodes or triangles, moved as one 8-byte word. */
struct duo {
    int32_t a, b;
};

static __device__ inline struct duo fetch_duo(const int32_t (*p)[2])
{
    return fetch_as<word8>((const struct duo *)(const void *)p);
}

static __device__ inline void put_duo(int32_t (*p)[2], struct duo e)
{
    put_as<word8>((struct duo *)(void *)p, e);
}

/* §1: which nodes of a pair descend: bit 0 the first node, bit 1 the second. */
static __device__ inline int descent(const struct tree *t, struct duo e)
{
    bool leaf_a = t->level[e.a] == 0, leaf_b = t->level[e.b] == 0;
    int ra = t->rank[e.a], rb = t->rank[e.b], d = 0;
    if (!leaf_a && (leaf_b || ra >= rb))
        d |= 1;
    if (!leaf_b && (leaf_a || rb >= ra))
        d |= 2;
    return d;
}

/* §1: replaces e by its parent pair. Returns false for a root pair. */
static __device__ inline bool ascend(const struct tree *t, struct duo *e)
{
    struct duo up = {t->parent[e->a], t->parent[e->b]};
    if (up.a < 0 && up.b < 0)
        return false;
    int ra = t->rank[e->a], rb = t->rank[e->b];
    bool up_a = up.a >= 0 && (up.b < 0 || ra <= rb);
    bool up_b = up.b >= 0 && (up.a < 0 || rb <= ra);
    e->a = up_a ? up.a : e->a;
    e->b = up_b ? up.b : e->b;
    return true;
}

/* §1: returns a mask: bit 4 i + j is set if there is a child pair of a's child
 * i and b's child j. A pair of one node with itself has those with i <= j. */
static __device__ inline uint32_t children(const struct tree *t, int d,
                                           struct duo e)
{
    uint32_t columns = d & 1 ? t->count[e.a] : 1;
    uint32_t row = (1u << (d & 2 ? t->count[e.b] : 1)) - 1;
    uint32_t mask = row * (0x1111u & ((1u << (4 * columns)) - 1));
    return e.a == e.b ? mask & 0x8cefu : mask;
}

static __device__ inline struct duo child(const struct tree *t, int d, int k,
                                          struct duo e)
{
    struct duo c = {d & 1 ? t->first[e.a] + (k >> 2) : e.a,
                    d & 2 ? t->first[e.b] + (k & 3) : e.b};
    return c;
}

/* §2, §4: whether a pair passes. */

static __device__ inline bool cleared(const struct tree *t,
                                      const uint8_t *clear, struct duo e)
{
    if (e.a >= t->n_cloth || e.b >= t->n_cloth || t->mesh[e.a] != t->mesh[e.b])
        return false;
    int di, dj;
    for (;;) {
        int32_t a = t->place[e.a], b = t->place[e.b];
        di = (b & 0xffff) - (a & 0xffff);
        dj = (b >> 16) - (a >> 16);
        if (di >= -1 && di <= 1 && dj >= -1 && dj <= 1)
            break;
        e.a = t->parent[e.a];
        e.b = t->parent[e.b];
    }
    /* The bit is stored with the southern node or, in one row, with the western
     * node. */
    bool swapped = dj < 0 || (dj == 0 && di < 0);
    if (swapped)
        di = -di;
    int bit = dj == 0 ? (di ? CLEAR_E : CLEAR_SELF) : CLEAR_N - di;
    return clear[swapped ? e.b : e.a] >> bit & 1;
}

template <class BOX>
static __device__ inline bool boxes_meet(const struct bvtt *s, real reach,
                                         struct duo e)
{
    return e.a == e.b || meets(fetch_box<BOX>(&s->box[e.a]),
                               fetch_box<BOX>(&s->box[e.b]), reach);
}

static __device__ inline bool passes(const struct bvtt *s, real reach,
                                     struct duo e)
{
    return boxes_meet<struct box>(s, reach, e) &&
           !cleared(&s->tree, s->clear, e);
}

static_assert((int)BVTT_BLOCK == (int)SCAN_BLOCK, "their places are scanned");

static __host__ __device__ inline int64_t blocks_of(int64_t n)
{
    return n / BVTT_BLOCK + (n % BVTT_BLOCK > 0);
}

/* Adds to a word of gpu_words. Integer sums do not depend on the order. */
static __device__ inline void word_add(int64_t *word, uint32_t count)
{
    if (count)
        atomicAdd((unsigned long long *)word, (unsigned long long)count);
}

#endif
