/* SPDX-License-Identifier: Apache-2.0 */
/* The boxes of the tree's nodes, level by level. spec/20_refit.md */
#include "ref/refit.h"

/* §1 of a leaf: over the vertices of its triangles. */
static void fit_leaf(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    const int32_t *order = t->order + t->first[a];
    struct box b = box_face(s->x0, s->x1, t->tri[order[0]]);
    uint8_t stir = s->n_moved == 0;
    for (int k = 0; k < t->count[a]; k++) {
        const int32_t *f = t->tri[order[k]];
        b = box_join(b, box_face(s->x0, s->x1, f));
        if (s->n_moved)
            stir |= s->moved[f[0]] | s->moved[f[1]] | s->moved[f[2]];
    }
    s->box[a] = b;
    s->stir[a] = stir;
}

/* §1 of an inner node: over its children. */
static void fit_inner(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    int32_t c = t->first[a];
    struct box b = s->box[c];
    uint8_t stir = s->stir[c];
    for (int k = 1; k < t->count[a]; k++) {
        b = box_join(b, s->box[c + k]);
        stir |= s->stir[c + k];
    }
    s->box[a] = b;
    s->stir[a] = stir;
}

int ref_refit(struct refit *s)
{
    for (int64_t k = 0; k < s->nv; k++)
        if (!vec_sane(s->x0[k]) || !vec_sane(s->x1[k]))
            return DRAPE_EDATA;

    int classes = s->all ? TREE_CLASSES : TREE_STATIC;
    for (int64_t l = 0; l < s->tree.levels; l++)
        for (int c = 0; c < classes; c++) {
            const int32_t *run = s->tree.range + c * s->tree.levels + l;
            EACH_MANY(run[1] - run[0])
            for (int32_t a = run[0]; a < run[1]; a++)
                if (l == 0)
                    fit_leaf(s, a);
                else
                    fit_inner(s, a);
        }
    return DRAPE_OK;
}
