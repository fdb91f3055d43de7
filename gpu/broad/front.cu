/* SPDX-License-Identifier: Apache-2.0 */
/* Moves the BVTT front on the device to where the boxes of this query put it.
 * spec/broad/front.md */
#include "gpu/broad/passes.cuh"

extern "C" {
#include "ref/broad/front.h"
}

/* The action of a pass on a pair: TEST it, KEEP it, or SPLIT it into its
 * children. */
enum { TEST, KEEP, SPLIT };
/* Words of gpu_words: pairs in the front, capacity that a pass needed, pairs
 * tested. */
enum { WORD_N, WORD_NEED, WORD_TESTED, WORDS };

/* §2, §5: chooses the action for a tested pair: a pair that passes and is above
 * the stop level is split. */
static __device__ uint8_t action_of(const struct front *s, bool in,
                                    struct duo e)
{
    const struct tree *t = &s->in.tree;
    if (!in || (t->level[e.a] <= s->stop && t->level[e.b] <= s->stop))
        return KEEP;
    return descent(t, e) ? SPLIT : KEEP;
}

/* The input and output streams of one pass. */
struct pass {
    int32_t (*pair)[2], (*other)[2];
    uint8_t *act, *act_other;
    int64_t n;
    real reach;
    struct tiles tiles;
    int64_t *word;
};

/* §3a: replaces pair k by its highest failing ancestor, and chooses its
 * action. */
static __device__ void climb_to_failing(const struct front *s,
                                        const struct pass *p, int64_t k)
{
    struct duo e = fetch_duo(&p->pair[k]);
    bool in = passes(&s->in, p->reach, e), moves = false;
    p->act[k] = action_of(s, in, e);
    for (struct duo up = e; !in && ascend(&s->in.tree, &up);) {
        in = passes(&s->in, p->reach, up);
        if (!in) {
            e = up;
            moves = true;
        }
    }
    if (moves)
        put_duo(&p->pair[k], e);
}

/* Returns how many pairs replace pair k, which is e. Siblings that were
 * replaced by one ancestor follow each other; only the first of them is
 * kept. */
static __device__ uint32_t count_successors(const struct tree *t,
                                            const struct pass *p, int64_t k,
                                            struct duo e, int act)
{
    if (act == SPLIT)
        return (uint32_t)__popc(children(t, descent(t, e), e));
    if (k == 0)
        return 1;
    struct duo before = fetch_duo(&p->pair[k - 1]);
    return e.a != before.a || e.b != before.b;
}

/* Tests pair k if it is new and writes its action. Returns how many pairs
 * replace it, plus 2^16 if it was new. */
static __device__ uint32_t count(const struct front *s, const struct pass *p,
                                 int64_t k)
{
    struct duo e = fetch_duo(&p->pair[k]);
    int act = p->act[k];
    bool fresh = act == TEST;
    if (fresh) {
        act = action_of(s, passes(&s->in, p->reach, e), e);
        p->act[k] = (uint8_t)act;
    }
    return count_successors(&s->in.tree, p, k, e, act) | (uint32_t)fresh << 16;
}

/* Runs count() for a tile. Writes the tile's number of outputs to its sum, and
 * adds the number of new pairs to the words. */
static __device__ void count_tile(const struct front *s, const struct pass *p,
                                  int64_t tile)
{
    int t = rank_thread();
    int64_t k = tile * BVTT_BLOCK + t;
    uint32_t total;
    block_scan(t, t < BVTT_BLOCK && k < p->n ? count(s, p, k) : 0, &total);
    if (t == 0) {
        p->tiles.sum[tile] = total & 0xffff;
        word_add(&p->word[WORD_TESTED], total >> 16);
    }
}

/* Writes the pairs that replace those of a tile, from the tile's place on. */
static __device__ void emit_successors(const struct tree *t,
                                       const struct pass *p, int64_t tile)
{
    int64_t k = tile * BVTT_BLOCK + rank_thread();
    struct duo e = {};
    uint32_t mask = 0, total;
    int d = 0;
    if (rank_thread() < BVTT_BLOCK && k < p->n) {
        e = fetch_duo(&p->pair[k]);
        d = p->act[k] == SPLIT ? descent(t, e) : 0;
        mask = d ? children(t, d, e) : count_successors(t, p, k, e, KEEP);
    }
    int64_t at = p->tiles.place[tile] +
                 block_scan(rank_thread(), (uint32_t)__popc(mask), &total);
    for (int c = 0; mask; c++, mask >>= 1)
        if (mask & 1) {
            put_duo(&p->other[at], child(t, d, c, e));
            p->act_other[at++] = d ? TEST : KEEP;
        }
}

static __device__ void swap_streams(struct pass *p)
{
    int32_t(*pair)[2] = p->pair;
    uint8_t *act = p->act;
    p->pair = p->other;
    p->act = p->act_other;
    p->other = pair;
    p->act_other = act;
}

/* A loop in which all threads together go through n pairs. */
#define EACH_PAIR(k, n)                                                        \
    for (int64_t k = group_rank() * (int64_t)rank_threads() + rank_thread();   \
         k < (n); k += group_ranks() * (int64_t)rank_threads())

/* §3: makes passes until no pair is new. The actions of all pairs must be set
 * before the first pass. Ends early where the capacity is too small. The second
 * barrier of a pass makes its output visible to all threads; sums and words of
 * the next pass are written after that. Returns the capacity that the last pass
 * needed. */
template <bool GRID>
static __device__ int64_t settle(const struct front *s, struct pass *p)
{
    int64_t need = 0;
    for (int64_t before = -1;;) {
        EACH_TILE(tile, blocks_of(p->n))
        count_tile(s, p, tile);
        group_sync<GRID>();
        int64_t tested = p->word[WORD_TESTED];
        if (tested == before)
            return need;
        before = tested;
        need = place_tiles(&p->tiles, blocks_of(p->n));
        if (need > s->cap)
            return need;
        EACH_TILE(tile, blocks_of(p->n))
        emit_successors(&s->in.tree, p, tile);
        swap_streams(p);
        p->n = need;
        group_sync<GRID>();
    }
}

template <int BLOCKS, bool GRID>
KERNEL front_kernel(const struct front &s, struct pass p)
{
    EACH_PAIR(k, p.n)
    climb_to_failing(&s, &p, k);
    group_sync<GRID>();
    int64_t need = settle<GRID>(&s, &p);
    EACH_PAIR(k, p.pair != s.pair ? p.n : 0)
    put_duo(&s.pair[k], fetch_duo(&p.pair[k]));
    if (group_rank() == 0 && rank_thread() == 0) {
        p.word[WORD_N] = p.n;
        p.word[WORD_NEED] = need;
    }
}

/* The pairs that the front may come to have. One that begins at the roots again
 * grows until it fills much of its capacity. */
static int64_t expected(const struct front *s)
{
    return s->n < s->cap / 16 ? s->cap : s->n;
}

int gpu_front(struct gpu *g, struct front *s)
{
    struct pass p = {s->pair, s->other,          s->act, s->act_other,
                     s->n,    reach_of(s->in.r), {},     NULL};
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    if (!take_tiles(g, s->cap, &p.tiles))
        return gpu_status(g);
    p.word = gpu_words(g);
    LAUNCH_PASSES(g, expected(s), front_kernel, *s, p);
    const int64_t *seen = gpu_read_back(g, WORDS);
    s->visited = s->n + seen[WORD_TESTED];
    s->need = seen[WORD_NEED];
    s->n = seen[WORD_N];
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    return s->need > s->cap ? DRAPE_EFULL : DRAPE_OK;
}
