/* SPDX-License-Identifier: Apache-2.0 */
/* Refits the boxes of the BVH level by level, from the leaves up.
 * spec/broad/refit.md */
#include "ref/broad/refit.h"

/* §1: returns the box of a leaf, around the vertices of its triangles. */
static struct box fit_leaf(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    const int32_t *order = t->order + t->first[a];
    struct box b = box_face(s->x0, s->x1, t->tri[order[0]]);
    for (int k = 1; k < t->count[a]; k++)
        b = box_join(b, box_face(s->x0, s->x1, t->tri[order[k]]));
    return b;
}

/* §1: returns the box of an inner node, around the boxes of its children. */
static struct box fit_inner(const struct refit *s, int32_t a)
{
    int32_t c = s->tree.first[a];
    struct box b = s->box[c];
    for (int k = 1; k < s->tree.count[a]; k++)
        b = box_join(b, s->box[c + k]);
    return b;
}

/* §4: whether a vertex of node a has moved. */
static uint8_t has_moved(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    uint8_t any = s->n_moved == 0;
    for (int k = 0; k < t->count[a] && !any; k++) {
        if (t->level[a] > 0) {
            any = s->stir[t->first[a] + k];
            continue;
        }
        const int32_t *f = t->tri[t->order[t->first[a] + k]];
        any = s->moved[f[0]] | s->moved[f[1]] | s->moved[f[2]];
    }
    return any;
}

static bool is_input_sane(const struct refit *s)
{
    for (int64_t k = 0; k < s->nv; k++)
        if ((s->n_moved == 0 || s->moved[k]) &&
            (!vec_sane(s->x0[k]) || !vec_sane(s->x1[k])))
            return false;
    return true;
}

/* Refits nodes [first, end) of one level. `still` marks nodes of static meshes,
 * which never stir. Returns how many boxes were made. */
static int64_t fit_level(const struct refit *s, int32_t first, int32_t end,
                         bool still)
{
    int64_t made = 0;
    COUNT_MANY(end - first, made)
    for (int32_t a = first; a < end; a++) {
        s->stir[a] = still ? 0 : has_moved(s, a);
        if (!still && !s->stir[a] && !s->every)
            continue;
        s->box[a] = s->tree.level[a] ? fit_inner(s, a) : fit_leaf(s, a);
        made++;
    }
    return made;
}

int ref_refit(struct refit *s)
{
    s->made = 0;
    if (!is_input_sane(s))
        return DRAPE_EDATA;
    int classes = s->all ? TREE_CLASSES : TREE_STATIC;
    for (int64_t l = 0; l < s->tree.levels; l++)
        for (int c = 0; c < classes; c++) {
            const int32_t *run = s->tree.range + c * s->tree.levels + l;
            s->made += fit_level(s, run[0], run[1], c == TREE_STATIC);
        }
    return DRAPE_OK;
}
