/* SPDX-License-Identifier: Apache-2.0 */
/* Traverses the BVTT from the front down to pairs of triangles.
 * spec/broad/walk.md */
#include "ref/broad/walk.h"

/* The input and the output stream of one pass. */
struct pass {
    const int32_t (*from)[2];
    int64_t n, cap;
    int32_t (*to)[2];
};

/* §1: whether a pair passes. *cleared counts pairs that stir and whose boxes
 * meet, so that only the cones reject them. */
static bool pair_passes(const struct walk *s, real reach, int32_t a, int32_t b,
                        int64_t *cleared)
{
    if (!(s->stir[a] | s->stir[b]) || !bvtt_meets(&s->in, reach, a, b))
        return false;
    bool clear = bvtt_clear(&s->in, a, b);
    *cleared += clear;
    return !clear;
}

/* Returns the mask of the children that pass. A pair of leaves counts as its
 * own only child. */
static uint32_t test_children(const struct walk *s, real reach,
                              const int32_t e[2], int64_t *cleared)
{
    const struct tree *t = &s->in.tree;
    int d = tree_descends(t, e[0], e[1]);
    if (d == 0)
        return 1;
    uint32_t mask = bvtt_children(t, d, e[0], e[1]);
    for (int k = 0; k < 16; k++) {
        int32_t a = e[0], b = e[1];
        if (!(mask >> k & 1))
            continue;
        bvtt_child(t, d, k, &a, &b);
        if (!pair_passes(s, reach, a, b, cleared))
            mask &= ~(1u << k);
    }
    return mask;
}

/* Computes the masks of a pass; the first pass tests its own pairs, too.
 * Returns how many pairs only the cones rejected. */
static int64_t test_all(const struct walk *s, real reach, const struct pass *p,
                        bool first)
{
    int64_t blocks = bvtt_blocks(p->n);
    EACH_MANY(p->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, cleared = 0;
        for (int64_t k = block * BVTT_BLOCK; k < p->n && k < end; k++) {
            const int32_t *e = p->from[k];
            bool in = !first || pair_passes(s, reach, e[0], e[1], &cleared);
            s->mask[k] =
                (uint16_t)(in ? test_children(s, reach, e, &cleared) : 0);
        }
        s->sum[block] = cleared;
    }
    return bvtt_scan(s->sum, blocks);
}

/* §2: returns the mask of the triangle pairs of two leaves whose boxes meet. */
static uint32_t test_leaves(const struct walk *s, real reach,
                            const int32_t e[2])
{
    const struct tree *t = &s->in.tree;
    const int32_t *of_a = t->order + t->first[e[0]];
    const int32_t *of_b = t->order + t->first[e[1]];
    struct box a[4], b[4];
    int na = t->count[e[0]], nb = t->count[e[1]];
    uint32_t mask = 0;
    for (int i = 0; i < na; i++)
        a[i] = box_face(s->x0, s->x1, t->tri[of_a[i]]);
    for (int j = 0; j < nb; j++)
        b[j] = box_face(s->x0, s->x1, t->tri[of_b[j]]);
    for (int i = 0; i < na; i++)
        for (int j = e[0] == e[1] ? i + 1 : 0; j < nb; j++)
            if (box_meets(&a[i], &b[j], reach))
                mask |= 1u << (4 * i + j);
    return mask;
}

/* Turns masks into the place where each block of pairs writes its output.
 * Returns the number of outputs. */
static int64_t place_outputs(const struct walk *s, int64_t n)
{
    int64_t blocks = bvtt_blocks(n);
    EACH_MANY(n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, count = 0;
        for (int64_t k = block * BVTT_BLOCK; k < n && k < end; k++)
            count += bvtt_bits(s->mask[k]);
        s->sum[block] = count;
    }
    return bvtt_scan(s->sum, blocks);
}

/* Writes the children that the masks name, or in the last pass the
 * triangles. */
static void write_outputs(const struct walk *s, const struct pass *p,
                          bool triangles)
{
    const struct tree *t = &s->in.tree;
    int64_t blocks = bvtt_blocks(p->n);
    EACH_MANY(p->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, at = s->sum[block];
        for (int64_t k = block * BVTT_BLOCK; k < p->n && k < end; k++) {
            int32_t a = p->from[k][0], b = p->from[k][1];
            int d = triangles ? 3 : tree_descends(t, a, b);
            for (int c = 0; s->mask[k] >> c; c++) {
                if (!(s->mask[k] >> c & 1))
                    continue;
                int32_t *to = p->to[at++];
                to[0] = a;
                to[1] = b;
                bvtt_child(t, d, c, &to[0], &to[1]);
                to[0] = triangles ? t->order[to[0]] : to[0];
                to[1] = triangles ? t->order[to[1]] : to[1];
            }
        }
    }
}

/* Makes passes until all pairs are leaves. A pass takes every pair down at
 * least one level on one side, so there are at most twice as many passes as
 * levels. */
static int descend_tree(struct walk *s, real reach, struct pass *p)
{
    p->from = s->front;
    p->n = s->n_front;
    p->to = s->pair;
    for (int64_t l = 0; l <= 2 * s->in.tree.levels; l++) {
        s->visited += p->n;
        s->cleared += test_all(s, reach, p, l == 0);
        int64_t n = place_outputs(s, p->n);
        s->need = n > s->need ? n : s->need;
        if (n > s->cap)
            return DRAPE_EFULL;
        write_outputs(s, p, false);
        p->from = (const int32_t(*)[2])p->to;
        p->to = p->to == s->pair ? s->other : s->pair;
        p->n = n;
        bool leaves = true;
        for (int64_t k = 0; k < n && leaves; k++)
            leaves = !tree_descends(&s->in.tree, p->from[k][0], p->from[k][1]);
        if (leaves)
            break;
    }
    return DRAPE_OK;
}

int ref_walk(struct walk *s)
{
    struct pass p = {0};
    real reach = box_reach(s->in.r);
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    s->n_tri = s->need_tri = s->visited = s->cleared = 0;
    s->need = s->n_front;
    if (s->n_front > s->cap || descend_tree(s, reach, &p) != DRAPE_OK)
        return DRAPE_EFULL;
    EACH_MANY(p.n)
    for (int64_t k = 0; k < p.n; k++)
        s->mask[k] = (uint16_t)test_leaves(s, reach, p.from[k]);
    s->need_tri = place_outputs(s, p.n);
    if (s->need_tri > s->cap_tri)
        return DRAPE_EFULL;
    p.to = s->tri;
    write_outputs(s, &p, true);
    s->n_tri = s->need_tri;
    return DRAPE_OK;
}
