/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of nodes on the device, and places in a stream for what a block of
 * items becomes. spec/22_front.md §1, §2, §4 */
#ifndef GPU_BVTT_CUH
#define GPU_BVTT_CUH

#include "gpu/box.cuh"

/* A pair of nodes, or of triangles, moved as one word of eight bytes. */
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

/* ---- §1: above and below a pair ---- */

/* Bit 0: the first node of the pair descends, bit 1: the second. */
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

/* To the pair from which e descended; false at roots. */
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

/* Bit 4 i + j: there is a child of a's child i and b's child j. Of a pair of
 * one node those with i <= j are there. */
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

/* ---- §2, §4: whether a pair is looked into ---- */

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
    /* Bits are of the node south or, in one row, west of the other. */
    bool turn = dj < 0 || (dj == 0 && di < 0);
    if (turn)
        di = -di;
    int bit = dj == 0 ? (di ? CLEAR_E : CLEAR_SELF) : CLEAR_N - di;
    return clear[turn ? e.b : e.a] >> bit & 1;
}

static __device__ inline bool boxes_meet(const struct bvtt *s, real reach,
                                         struct duo e)
{
    return e.a == e.b || meets(fetch_as<word16>(&s->box[e.a]),
                               fetch_as<word16>(&s->box[e.b]), reach);
}

static __device__ inline bool passes(const struct bvtt *s, real reach,
                                     struct duo e)
{
    return boxes_meet(s, reach, e) && !cleared(&s->tree, s->clear, e);
}

/* ---- Places in a block of BVTT_BLOCK items ---- */

static inline int64_t blocks_of(int64_t n)
{
    return n / BVTT_BLOCK + (n % BVTT_BLOCK > 0);
}

enum { SCAN_RUN = 16, SCAN_RUNS = BVTT_BLOCK / SCAN_RUN };

/* What the threads before this one have together; *total: all of them. Every
 * thread of a block of BVTT_BLOCK must call it. Two counts go at once in the
 * halves of a word, as no block's exceed 16 bits. */
static __device__ inline uint32_t block_scan(uint32_t count, uint32_t *total)
{
    __shared__ uint32_t s[SCAN_RUNS * (SCAN_RUN + 1)], run[SCAN_RUNS];
    int t = (int)threadIdx.x, at = t + t / SCAN_RUN; /* no two in one bank */
    __syncthreads(); /* s may be read still from the scan before */
    s[at] = count;
    __syncthreads();
    if (t < SCAN_RUNS) {
        uint32_t sum = 0;
        for (int k = t * (SCAN_RUN + 1); k < (t + 1) * (SCAN_RUN + 1) - 1;
             k++) {
            uint32_t here = s[k];
            s[k] = sum;
            sum += here;
        }
        run[t] = sum;
    }
    __syncthreads();
    uint32_t before = 0, all = 0;
    for (int k = 0; k < SCAN_RUNS; k++) {
        before = k == t / SCAN_RUN ? all : before;
        all += run[k];
    }
    *total = all;
    return before + s[at];
}

/* Blocks' counts [n] become the places where each begins. All threads of one
 * block of BVTT_BLOCK call it; a chunk has at most 2^19 · BVTT_BLOCK items. */
static __device__ inline void place_blocks(int64_t *sum, int64_t n)
{
    enum { EACH = 8 };
    int64_t base = 0;
    for (int64_t first = 0; first < n; first += EACH * BVTT_BLOCK) {
        int64_t at = first + EACH * (int64_t)threadIdx.x;
        uint32_t mine[EACH], all = 0, total;
        for (int k = 0; k < EACH; k++) {
            mine[k] = at + k < n ? (uint32_t)sum[at + k] : 0;
            all += mine[k];
        }
        int64_t before = base + block_scan(all, &total);
        for (int k = 0; k < EACH && at + k < n; k++) {
            sum[at + k] = before;
            before += mine[k];
        }
        base += total;
    }
}

/* Adds to a word of gpu_words: whole numbers, so no order shows. */
static __device__ inline void word_add(int64_t *word, uint32_t count)
{
    if (count)
        atomicAdd((unsigned long long *)word, (unsigned long long)count);
}

#endif
