/* SPDX-License-Identifier: Apache-2.0 */
/* Moves the front of node pairs to where the boxes now are.
 * spec/22_front.md */
#include "gpu/bvtt.cuh"

/* What becomes of a pair in a pass. */
enum { TEST, KEEP, SPLIT };
/* Passes that are queued before the host looks, and the words of each: what
 * the pairs become, how many were new, 1: they have become it. */
enum { WORD_NEED, WORD_TESTED, WORD_DONE, WORDS, PASSES = 5 };

/* What a pass reads besides. */
struct pass {
    real reach;
    int64_t *word; /* [WORDS] of this pass, behind those of the ones before */
    int64_t bound; /* of pairs: its blocks are enough for so many */
    bool all;      /* it is done even if nothing is new */
    bool later;    /* its pairs are those that the pass before has made */
};

/* The pairs of a pass, none if it is not to be. */
static __device__ int64_t pairs_of(const struct front *s, const struct pass *p)
{
    const int64_t *before = p->word - WORDS;
    if (!p->later)
        return s->n;
    bool good = before[WORD_DONE] && before[WORD_NEED] <= p->bound;
    return good ? before[WORD_NEED] : 0;
}

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
    front_count_kernel(struct front s, struct pass p)
{
    int64_t first = (int64_t)blockIdx.x * BVTT_BLOCK, k = first + threadIdx.x;
    int64_t n = pairs_of(&s, &p);
    uint32_t count = 0, total;
    if (first >= n)
        return;
    if (k < n) {
        struct duo e = fetch_duo(&s.pair[k]);
        int act = s.act[k];
        if (act == TEST) {
            act = judge(&s, passes(&s.in, p.reach, e), e);
            s.act[k] = (uint8_t)act;
            count = 1u << 16;
        }
        count += becomes(&s, k, e, act);
    }
    block_scan(count, &total);
    if (threadIdx.x == 0) {
        s.sum[blockIdx.x] = total & 0xffff;
        word_add(&p.word[WORD_NEED], total & 0xffff);
        word_add(&p.word[WORD_TESTED], total >> 16);
    }
}

/* One block: where the blocks' pairs go, if they go on. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    front_place_kernel(struct front s, struct pass p)
{
    int64_t n = pairs_of(&s, &p);
    bool on = n > 0 && (p.all || p.word[WORD_TESTED] > 0) &&
              p.word[WORD_NEED] <= s.cap;
    if (on)
        place_blocks(s.sum, (n + BVTT_BLOCK - 1) / BVTT_BLOCK);
    if (threadIdx.x == 0)
        p.word[WORD_DONE] = on;
}

/* Block k owns the same pairs: writes what they become from sum[k] on. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    front_emit_kernel(struct front s, struct pass p)
{
    int64_t first = (int64_t)blockIdx.x * BVTT_BLOCK, k = first + threadIdx.x;
    const struct tree *t = &s.in.tree;
    int64_t n = p.word[WORD_DONE] ? pairs_of(&s, &p) : 0;
    struct duo e = {};
    uint32_t mask = 0, total;
    int d = 0;
    if (first >= n)
        return;
    if (k < n) {
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

/* PASSES passes, each if the one before was done, and what they counted. */
static const int64_t *queue(struct gpu *g, const struct front *s, real reach,
                            bool all, int64_t bound)
{
    struct front now = *s;
    struct pass p = {reach, gpu_words(g), bound, all, false};
    int64_t blocks = blocks_of(s->n);
    for (int k = 0; k < PASSES; k++) {
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, front_count_kernel, now, p);
        LAUNCH_BLOCKS(g, 1, BVTT_BLOCK, front_place_kernel, now, p);
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, front_emit_kernel, now, p);
        swap_streams(&now);
        p.word += WORDS;
        p.all = false;
        p.later = true;
        blocks = blocks_of(bound);
    }
    return gpu_read_words(g, PASSES * WORDS);
}

/* Passes until nothing is new. The first finds all judged. */
static int settle(struct gpu *g, struct front *s, real reach)
{
    for (bool all = true;; all = false) {
        int64_t bound = s->n + s->n / 4 + 1024;
        bound = bound < s->cap ? bound : s->cap;
        const int64_t *seen = queue(g, s, reach, all, bound);
        if (gpu_status(g) != DRAPE_OK)
            return gpu_status(g);
        bool on = true;
        for (int k = 0; k < PASSES && on; k++, seen += WORDS) {
            if (!(all && k == 0) && seen[WORD_TESTED] == 0)
                return DRAPE_OK;
            s->visited += seen[WORD_TESTED];
            s->need = seen[WORD_NEED];
            if (s->need > s->cap)
                return DRAPE_EFULL;
            swap_streams(s);
            s->n = s->need;
            on = s->n <= bound;
        }
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
