/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage walk. spec/broad/walk.md */
#include "ref/broad/walk.h"
#include "tests/broad/fabric.h"

const struct field fields_walk[] = {FABRIC_BVTT(walk),
                                    IN(walk, x0, nv, 1),
                                    IN(walk, x1, nv, 1),
                                    IN(walk, stir, in.tree.n, 1),
                                    IN(walk, front, n_front, 1),
                                    SCRATCH(walk, pair, cap, 1),
                                    SCRATCH(walk, other, cap, 1),
                                    SCRATCH(walk, mask, cap, 1),
                                    SCRATCH(walk, sum, cap, 1),
                                    OUT_USED(walk, tri, cap_tri, 1, n_tri),
                                    OUT_VALUE(walk, n_tri),
                                    OUT_VALUE(walk, visited),
                                    OUT_VALUE(walk, cleared),
                                    FIELD_END};

/* Marks one leaf in four, and all nodes above it, as stirred. */
static void stir_few(struct bytes *b, const struct tree *t, uint8_t *stir)
{
    memset(stir, 0, (size_t)t->n);
    for (int32_t k = 0; k < t->n; k++)
        if (t->level[k] == 0 && pick(b, 4) == 0)
            for (int32_t a = k; a >= 0; a = t->parent[a])
                stir[a] = 1;
}

void gen_walk(struct bytes *b, struct walk *s)
{
    struct fabric_walk w;
    fabric_walk(b, &w);
    s->in = w.in;
    s->nv = w.f.scene.vertices;
    s->x0 = w.f.x0;
    s->x1 = w.f.x1;
    if (pick(b, 3) == 0)
        stir_few(b, &s->in.tree, w.stir);
    s->stir = w.stir;
    s->n_front = w.roots;
    s->front = (const int32_t(*)[2])w.root;
    s->cap = 1 << 18;
    s->cap_tri = 1 << 18;
    if (pick(b, 8) == 0)
        s->cap_tri = 3;
    if (pick(b, 8) == 0)
        s->cap = 3;
}

/* Whether §2 demands a pair of triangles in two leaves. */
static bool wanted(const struct walk *s, const int32_t leaf[2],
                   const int32_t tri[2])
{
    const struct tree *t = &s->in.tree;
    struct box a = box_face(s->x0, s->x1, t->tri[tri[0]]);
    struct box b = box_face(s->x0, s->x1, t->tri[tri[1]]);
    return (s->stir[leaf[0]] | s->stir[leaf[1]]) &&
           box_meets(&a, &b, box_reach(s->in.r)) &&
           !bvtt_clear(&s->in, leaf[0], leaf[1]);
}

/* Counts the triangle pairs that §2 demands below a root pair. */
static int64_t count_wanted(const struct walk *s, const int32_t root[2])
{
    const struct tree *t = &s->in.tree;
    int64_t count = 0;
    for (int32_t a = 0; a < t->n; a++)
        for (int32_t b = root[0] == root[1] ? a : 0; b < t->n; b++) {
            int32_t leaf[2] = {a, b};
            if (t->level[a] || t->mesh[a] != t->mesh[root[0]])
                break;
            if (t->level[b] || t->mesh[b] != t->mesh[root[1]])
                continue;
            for (int i = 0; i < t->count[a]; i++)
                for (int j = a == b ? i + 1 : 0; j < t->count[b]; j++) {
                    int32_t tri[2] = {t->order[t->first[a] + i],
                                      t->order[t->first[b] + j]};
                    count += wanted(s, leaf, tri);
                }
        }
    return count;
}

/* §1: counts the pairs below (a, b) that only the cones reject. Their boxes
 * need no test, because neighbours have a vertex in common. */
static int64_t count_cleared(const struct walk *s, int32_t a, int32_t b)
{
    const struct tree *t = &s->in.tree;
    const struct box *box = s->in.box;
    int64_t count = 0;
    if (!(s->stir[a] | s->stir[b]))
        return 0;
    if (bvtt_clear(&s->in, a, b))
        return 1;
    if (a != b && !box_meets(&box[a], &box[b], box_reach(s->in.r)))
        return 0;
    int d = tree_descends(t, a, b);
    for (int i = 0; d && i < (d & 1 ? t->count[a] : 1); i++)
        for (int j = a == b ? i : 0; j < (d & 2 ? t->count[b] : 1); j++)
            count += count_cleared(s, d & 1 ? t->first[a] + i : a,
                                   d & 2 ? t->first[b] + j : b);
    return count;
}

/* Returns the place of a triangle in the order of the leaves. */
static int32_t rank_of(const struct tree *t, int32_t tri)
{
    int32_t k = 0;
    while (t->order[k] != tri)
        k++;
    return k;
}

/* Returns the mesh of triangle t->order[rank]. */
static int mesh_of(const struct tree *t, int32_t rank)
{
    int32_t a = 0;
    while (t->level[a] || rank < t->first[a] ||
           rank >= t->first[a] + t->count[a])
        a++;
    return t->mesh[a];
}

/* §1: every pair that only the cones reject is counted. §2: exactly the pairs
 * of triangles that meet are found, none twice. §3: pairs are in the order of
 * the walk, so in one pair of meshes pairs with the same first triangle come in
 * ascending order. */
const char *prop_walk(const struct walk *s)
{
    const struct tree *t = &s->in.tree;
    int64_t count = 0, cleared = 0;
    for (int64_t k = 0; k < s->n_front; k++) {
        count += count_wanted(s, s->front[k]);
        cleared += count_cleared(s, s->front[k][0], s->front[k][1]);
    }
    EXPECT(count == s->n_tri);
    EXPECT(cleared == s->cleared);
    for (int64_t k = 0; k < s->n_tri; k++) {
        EXPECT(s->tri[k][0] != s->tri[k][1]);
        if (k == 0 || s->tri[k][0] != s->tri[k - 1][0])
            continue;
        int32_t to = rank_of(t, s->tri[k][1]);
        int32_t last = rank_of(t, s->tri[k - 1][1]);
        EXPECT(mesh_of(t, to) != mesh_of(t, last) || to > last);
    }
    return NULL;
}
