/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage refit. spec/broad/refit.md */
#include <stdlib.h>

#include "ref/broad/refit.h"
#include "tests/broad/fabric.h"

const struct field fields_refit[] = {FABRIC_TREE(refit, tree),
                                     IN(refit, x0, nv, 1),
                                     IN(refit, x1, nv, 1),
                                     IN(refit, moved, n_moved, 1),
                                     INOUT(refit, box, tree.n, 1),
                                     INOUT(refit, stir, tree.n, 1),
                                     FIELD_END};

/* Makes the kept boxes of a later query: boxes from before some vertices
 * moved. */
static void move_some(struct bytes *b, struct refit *s, vec *x1)
{
    uint8_t *moved = take(b, s->nv, 1);
    vec *now = take(b, s->nv, sizeof *now);
    memcpy(now, x1, (size_t)s->nv * sizeof *now);
    uint32_t few = 2 + pick(b, 200);
    for (int64_t v = 0; v < s->nv; v++) {
        moved[v] = pick(b, few) == 0;
        if (moved[v])
            x1[v] = pick_vec(b, 1);
    }
    bool all = s->all;
    s->all = 1;
    if (ref_refit(s) != DRAPE_OK)
        abort();
    s->all = all;
    memcpy(x1, now, (size_t)s->nv * sizeof *now);
    s->moved = moved;
    s->n_moved = s->nv;
}

void gen_refit(struct bytes *b, struct refit *s)
{
    struct fabric f;
    struct tree_map map;
    fabric_choose(b, &f, &s->tree, &map);
    s->nv = f.scene.vertices;
    s->x0 = f.x0;
    s->x1 = f.x1;
    s->all = pick(b, 3) > 0;
    s->box = take(b, s->tree.n, sizeof *s->box);
    s->stir = take(b, s->tree.n, 1);
    if (pick(b, 2))
        move_some(b, s, f.x1);
    s->every = pick(b, 3) == 0;
    if (s->nv > 0 && pick(b, 16) == 0) {
        uint32_t v = pick(b, (uint32_t)s->nv);
        f.x1[v].y = 2 * REAL_BIG;
        if (s->n_moved)
            ((uint8_t *)s->moved)[v] = 1;
    }
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
    bool still = a >= t->range[TREE_STATIC * t->levels];
    uint8_t stir = s->n_moved == 0 && !still;
    for (int32_t k = leaf; k < end; k++)
        for (int c = 0; c < 3; c++) {
            int32_t v = t->tri[t->order[k]][c];
            struct box p = box_point(s->x0[v], s->x1[v]);
            EXPECT(within(b.lo0, s->x0[v], b.hi0));
            EXPECT(within(b.lo1, s->x1[v], b.hi1));
            tight = k == leaf && c == 0 ? p : box_join(tight, p);
            stir |= !still && s->n_moved && s->moved[v];
        }
    EXPECT(equal(tight.lo0, b.lo0) && equal(tight.hi0, b.hi0));
    EXPECT(equal(tight.lo1, b.lo1) && equal(tight.hi1, b.hi1));
    EXPECT(s->stir[a] == stir);
    return NULL;
}

/* §1, §4: boxes, new or kept, hold all vertices of their triangles and are
 * tight; the stir flags and the number of boxes made are right. */
const char *prop_refit(const struct refit *s)
{
    const struct tree *t = &s->tree;
    int32_t fixed = t->range[TREE_STATIC * t->levels];
    int64_t made = s->all ? t->n - fixed : 0;
    for (int32_t a = 0; a < fixed; a++)
        made += s->every || s->stir[a];
    EXPECT(s->made == made);
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
