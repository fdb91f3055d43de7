/* SPDX-License-Identifier: Apache-2.0 */
/* Moves the front of node pairs to where the boxes now are.
 * spec/22_front.md */
#include "gpu/bvtt.cuh"

/* What becomes of a pair in a pass, and the words that count. */
enum { TEST, KEEP, SPLIT };
enum { WORD_NEED, WORD_TESTED, WORDS };

/* §2: a pair that passes and may be split is; all others are settled. */
static __device__ uint8_t judge(const struct front *s, bool in, struct duo e)
{
    const struct tree *t = &s->in.tree;
    if (!in || (t->level[e.a] <= s->stop && t->level[e.b] <= s->stop))
        return KEEP;
    return descent(t, e) ? SPLIT : KEEP;
}

/* Thread k owns pair k: §3, to its highest ancestor that fails, in place, and
 * what becomes of it. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    front_raise_kernel(struct front s, real reach)
{
    ITEM(k, s.n);
    struct duo e = fetch_duo(&s.pair[k]);
    bool in = passes(&s.in, reach, e), moves = false;
    s.act[k] = judge(&s, in, e);
    for (struct duo up = e; !in && ascend(&s.in.tree, &up);) {
        in = passes(&s.in, reach, up);
        if (!in) {
            e = up;
            moves = true;
        }
    }
    if (moves)
        put_duo(&s.pair[k], e);
}

/* How many pairs pair k, which is e, becomes: of siblings that gave way to one
 * parent, which follow each other, the first stays. */
static __device__ uint32_t becomes(const struct front *s, int64_t k,
                                   struct duo e, int act)
{
    const struct tree *t = &s->in.tree;
    if (act == SPLIT)
        return (uint32_t)__popc(children(t, descent(t, e), e));
    if (k == 0)
        return 1;
    struct duo before = fetch_duo(&s->pair[k - 1]);
    return e.a != before.a || e.b != before.b;
}

/* Block k owns pairs 256 k …: judges those that are new, writes act and how
 * many pairs they all become to sum[k], and adds to the words. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    front_count_kernel(struct front s, real reach, int64_t *word)
{
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    uint32_t count = 0, total;
    if (k < s.n) {
        struct duo e = fetch_duo(&s.pair[k]);
        int act = s.act[k];
        if (act == TEST) {
            act = judge(&s, passes(&s.in, reach, e), e);
            s.act[k] = (uint8_t)act;
            count = 1u << 16;
        }
        count += becomes(&s, k, e, act);
    }
    block_scan(count, &total);
    if (threadIdx.x == 0) {
        s.sum[blockIdx.x] = total & 0xffff;
        word_add(&word[WORD_NEED], total & 0xffff);
        word_add(&word[WORD_TESTED], total >> 16);
    }
}

/* Block k owns the same pairs: writes what they become from sum[k] on. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    front_emit_kernel(struct front s)
{
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    const struct tree *t = &s.in.tree;
    struct duo e = {};
    uint32_t mask = 0, total;
    int d = 0;
    if (k < s.n) {
        e = fetch_duo(&s.pair[k]);
        d = s.act[k] == SPLIT ? descent(t, e) : 0;
        mask = d ? children(t, d, e) : becomes(&s, k, e, KEEP);
    }
    int64_t at = s.sum[blockIdx.x] + block_scan(__popc(mask), &total);
    for (int c = 0; mask; c++, mask >>= 1)
        if (mask & 1) {
            put_duo(&s.other[at], child(t, d, c, e));
            s.act_other[at++] = d ? TEST : KEEP;
        }
}

static void swap_streams(struct front *s)
{
    int32_t(*pair)[2] = s->pair;
    uint8_t *act = s->act;
    s->pair = s->other;
    s->act = s->act_other;
    s->other = pair;
    s->act_other = act;
}

/* Passes until nothing is new. The first finds all judged. */
static int settle(struct gpu *g, struct front *s, real reach)
{
    for (bool first = true;; first = false) {
        int64_t *word = gpu_words(g), blocks = blocks_of(s->n);
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, front_count_kernel, *s, reach,
                      word);
        const int64_t *seen = gpu_read_words(g, WORDS);
        if (gpu_status(g) != DRAPE_OK)
            return gpu_status(g);
        if (!first && seen[WORD_TESTED] == 0)
            return DRAPE_OK;
        s->visited += seen[WORD_TESTED];
        s->need = seen[WORD_NEED];
        if (s->need > s->cap)
            return DRAPE_EFULL;
        gpu_scan(g, s->sum, blocks);
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, front_emit_kernel, *s);
        swap_streams(s);
        s->n = s->need;
    }
}

int gpu_front(struct gpu *g, struct front *s)
{
    int32_t(*home)[2] = s->pair;
    real reach = reach_of(s->in.r);
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    s->visited = s->n;
    LAUNCH(g, s->n, front_raise_kernel, *s, reach);
    int status = settle(g, s, reach);
    if (status == DRAPE_OK && s->pair != home) {
        gpu_copy(g, home, s->pair, (size_t)s->n * sizeof *home);
        swap_streams(s);
    }
    return status == DRAPE_OK ? gpu_status(g) : status;
}
