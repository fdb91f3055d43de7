/* SPDX-License-Identifier: Apache-2.0 */
/* Stage refit: generator and properties. spec/20_refit.md */
#include "tests/fabric.h"

const struct field fields_refit[] = {FABRIC_TREE(refit, tree),
                                     IN(refit, x0, nv, 1),
                                     IN(refit, x1, nv, 1),
                                     IN(refit, moved, n_moved, 1),
                                     INOUT(refit, box, tree.n, 1),
                                     INOUT(refit, stir, tree.n, 1),
                                     FIELD_END};

void gen_refit(struct bytes *b, struct refit *s)
{
    struct fabric f;
    struct tree_map map;
    fabric_choose(b, &f, &s->tree, &map);
    s->nv = f.scene.vertices;
    s->x0 = f.x0;
    s->x1 = f.x1;
    s->all = pick(b, 3) > 0;
    s->n_moved = pick(b, 2) ? s->nv : 0;
    uint8_t *moved = take(b, s->n_moved, 1);
    for (int64_t v = 0; v < s->n_moved; v++)
        moved[v] = pick(b, 16) == 0;
    s->moved = moved;
    s->box = take(b, s->tree.n, sizeof *s->box);
    s->stir = take(b, s->tree.n, 1);
    if (s->nv > 0 && pick(b, 16) == 0)
        f.x1[pick(b, (uint32_t)s->nv)].y = 2 * REAL_BIG;
}

static bool within(vec lo, vec x, vec hi)
{
    return lo.x <= x.x && x.x <= hi.x && lo.y <= x.y && x.y <= hi.y &&
           lo.z <= x.z && x.z <= hi.z;
}

static bool equal(vec a, vec b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static const char *check_node(const struct refit *s, int32_t a, int32_t leaf,
                              int32_t end)
{
    const struct tree *t = &s->tree;
    struct box b = s->box[a], tight = b;
    uint8_t stir = s->n_moved == 0;
    for (int32_t k = leaf; k < end; k++)
        for (int c = 0; c < 3; c++) {
            int32_t v = t->tri[t->order[k]][c];
            struct box p = box_point(s->x0[v], s->x1[v]);
            EXPECT(within(b.lo0, s->x0[v], b.hi0));
            EXPECT(within(b.lo1, s->x1[v], b.hi1));
            tight = k == leaf && c == 0 ? p : box_join(tight, p);
            stir |= s->n_moved && s->moved[v];
        }
    EXPECT(equal(tight.lo0, b.lo0) && equal(tight.hi0, b.hi0));
    EXPECT(equal(tight.lo1, b.lo1) && equal(tight.hi1, b.hi1));
    EXPECT(s->stir[a] == stir);
    return NULL;
}

/* §1, §4: boxes hold all vertices of their triangles and are tight; flags. */
const char *prop_refit(const struct refit *s)
{
    const struct tree *t = &s->tree;
    int32_t fixed = t->range[TREE_STATIC * t->levels];
    for (int32_t a = 0; a < t->n && (s->all || a < fixed); a++) {
        int32_t first = a, last = a;
        while (t->level[first] > 0)
            first = t->first[first];
        while (t->level[last] > 0)
            last = t->first[last] + t->count[last] - 1;
        const char *failed =
            check_node(s, a, t->first[first], t->first[last] + t->count[last]);
        if (failed)
            return failed;
    }
    return NULL;
}
