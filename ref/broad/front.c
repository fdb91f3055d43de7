/* SPDX-License-Identifier: Apache-2.0 */
/* Moves the BVTT front up and down to where the boxes of this query put it.
 * spec/broad/front.md */
#include "ref/broad/front.h"

/* The action of a pass on a pair: TEST it, KEEP it, or SPLIT it into its
 * children. */
enum { TEST, KEEP, SPLIT };

/* §2, §5: chooses the action for a tested pair. A pair that passes and is above
 * the stop level is split. Every other pair is kept. */
static uint8_t action_of(const struct front *s, bool passes, int32_t a,
                         int32_t b)
{
    const struct tree *t = &s->in.tree;
    if (!passes || tree_descends(t, a, b) == 0)
        return KEEP;
    return t->level[a] > s->stop || t->level[b] > s->stop ? SPLIT : KEEP;
}

/* §3a: replaces a pair that fails by its highest failing ancestor. All
 * ancestors of a pair that passes pass, so the climb ends at the first ancestor
 * that passes. */
static void climb_to_failing(const struct front *s, real reach, int64_t k)
{
    int32_t a = s->pair[k][0], b = s->pair[k][1];
    bool in = bvtt_passes(&s->in, reach, a, b);
    s->act[k] = action_of(s, in, a, b);
    while (!in && tree_ascend(&s->in.tree, &a, &b)) {
        in = bvtt_passes(&s->in, reach, a, b);
        if (!in) {
            s->pair[k][0] = a;
            s->pair[k][1] = b;
        }
    }
}

/* Returns how many pairs replace pair k. Siblings that were replaced by one
 * ancestor follow each other in the stream; only the first of such equal
 * neighbours is kept. */
static int64_t count_successors(const struct front *s, int64_t k)
{
    const int32_t *e = s->pair[k], *before = s->pair[k > 0 ? k - 1 : 0];
    const struct tree *t = &s->in.tree;
    if (s->act[k] == SPLIT)
        return bvtt_bits(
            bvtt_children(t, tree_descends(t, e[0], e[1]), e[0], e[1]));
    return k == 0 || e[0] != before[0] || e[1] != before[1];
}

/* Writes the pairs that replace pair k to place `at` and on. Returns the place
 * after them. */
static int64_t emit_successors(const struct front *s, int64_t k, int64_t at)
{
    const struct tree *t = &s->in.tree;
    int32_t a = s->pair[k][0], b = s->pair[k][1];
    int d = s->act[k] == SPLIT ? tree_descends(t, a, b) : 0;
    uint32_t mask =
        d ? bvtt_children(t, d, a, b) : (uint32_t)count_successors(s, k);
    for (int c = 0; c < 16; c++) {
        if (!(mask >> c & 1))
            continue;
        int32_t *to = s->other[at];
        to[0] = a;
        to[1] = b;
        bvtt_child(t, d, c, &to[0], &to[1]);
        s->act_other[at++] = d ? TEST : KEEP;
    }
    return at;
}

/* Makes one pass over the stream, whose actions are known: count by block,
 * scan, write, swap the two streams. Returns false where the capacity is too
 * small. */
static bool make_pass(struct front *s)
{
    int64_t blocks = bvtt_blocks(s->n);
    EACH_MANY(s->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, count = 0;
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++)
            count += count_successors(s, k);
        s->sum[block] = count;
    }
    s->need = bvtt_scan(s->sum, blocks);
    if (s->need > s->cap)
        return false;
    EACH_MANY(s->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, at = s->sum[block];
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++)
            at = emit_successors(s, k, at);
    }
    int32_t(*swap)[2] = s->pair;
    uint8_t *swap_act = s->act;
    s->pair = s->other;
    s->act = s->act_other;
    s->other = swap;
    s->act_other = swap_act;
    s->n = s->need;
    return true;
}

/* Tests the pairs that the last pass created and chooses their actions. Returns
 * how many pairs were tested. */
static int64_t test_new(struct front *s, real reach)
{
    int64_t blocks = bvtt_blocks(s->n);
    EACH_MANY(s->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, count = 0;
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++)
            if (s->act[k] == TEST) {
                int32_t a = s->pair[k][0], b = s->pair[k][1];
                bool in = bvtt_passes(&s->in, reach, a, b);
                s->act[k] = action_of(s, in, a, b);
                count++;
            }
        s->sum[block] = count;
    }
    return bvtt_scan(s->sum, blocks);
}

int ref_front(struct front *s)
{
    int32_t(*home)[2] = s->pair;
    real reach = box_reach(s->in.r);
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    s->visited = s->n;
    EACH_MANY(s->n)
    for (int64_t k = 0; k < s->n; k++)
        climb_to_failing(s, reach, k);
    for (int64_t tested = 1; tested > 0; s->visited += tested) {
        if (!make_pass(s))
            return DRAPE_EFULL;
        tested = test_new(s, reach);
    }
    if (s->pair != home) {
        EACH_MANY(s->n)
        for (int64_t k = 0; k < s->n; k++) {
            home[k][0] = s->pair[k][0];
            home[k][1] = s->pair[k][1];
        }
        s->other = s->pair;
        s->pair = home;
    }
    return DRAPE_OK;
}
