/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage front. spec/broad/front.md */
#include "ref/broad/front.h"
#include "tests/broad/fabric.h"

const struct field fields_front[] = {FABRIC_BVTT(front),
                                     FIELD_(FIELD_INOUT, front, pair, 1,
                                            (long)offsetof(struct front, cap),
                                            (long)offsetof(struct front, n), 0),
                                     SCRATCH(front, other, cap, 1),
                                     SCRATCH(front, act, cap, 1),
                                     SCRATCH(front, act_other, cap, 1),
                                     SCRATCH(front, sum, cap, 1),
                                     OUT_VALUE(front, need),
                                     OUT_VALUE(front, visited),
                                     FIELD_END};

/* A recursive traversal from the roots, which writes its front to to[n …]. */
struct from_roots {
    const struct front *s;
    int32_t (*to)[2];
    int64_t cap, n;
};

static void from_root(struct from_roots *u, int32_t a, int32_t b)
{
    const struct front *s = u->s;
    const struct tree *t = &s->in.tree;
    int d = tree_descends(t, a, b);
    bool whole = d == 0 || (t->level[a] <= s->stop && t->level[b] <= s->stop);
    if (whole || !bvtt_passes(&s->in, box_reach(s->in.r), a, b)) {
        if (u->n < u->cap) {
            u->to[u->n][0] = a;
            u->to[u->n][1] = b;
        }
        u->n++;
        return;
    }
    for (int i = 0; i < (d & 1 ? t->count[a] : 1); i++)
        for (int j = a == b ? i : 0; j < (d & 2 ? t->count[b] : 1); j++)
            from_root(u, d & 1 ? t->first[a] + i : a,
                      d & 2 ? t->first[b] + j : b);
}

void gen_front(struct bytes *b, struct front *s)
{
    struct fabric_walk w;
    fabric_walk(b, &w);
    s->in = w.in;
    s->stop = for_bench(b) ? 2 : pick(b, 4);
    struct from_roots u = {.s = s};
    for (int64_t k = 0; k < w.roots; k++)
        from_root(&u, w.root[k][0], w.root[k][1]);
    int64_t room = u.n + w.roots;
    /* Begin at the roots or at the front of another motion; sometimes the
     * capacity is too small. */
    for (int32_t v = 0; v < w.f.scene.vertices; v++)
        w.f.x1[v].x += R(0.03) * fabric_random(&w.f);
    const struct box *box = s->in.box;
    s->in.box = fabric_boxes(b, &w.f, &s->in.tree, w.stir);
    u.n = 0;
    for (int64_t k = 0; k < w.roots; k++)
        from_root(&u, w.root[k][0], w.root[k][1]);
    room += u.n;
    s->cap = 2 * room + 1;
    s->pair = take(b, s->cap, sizeof *s->pair);
    u.to = s->pair;
    u.cap = s->cap;
    u.n = 0;
    if (pick(b, 2))
        for (int64_t k = 0; k < w.roots; k++)
            from_root(&u, w.root[k][0], w.root[k][1]);
    else
        for (; u.n < w.roots; u.n++)
            memcpy(u.to[u.n], w.root[u.n], sizeof u.to[0]);
    s->n = u.n;
    s->in.box = box;
    if (pick(b, 8) == 0)
        s->cap = s->n > 0 ? s->n : 1;
}

/* Finds the root pair above a pair. */
static void climb(const struct tree *t, const int32_t e[2], int32_t to[2])
{
    to[0] = e[0];
    to[1] = e[1];
    while (tree_ascend(t, &to[0], &to[1]))
        continue;
}

/* §3: the front is the front of a traversal from the roots, in its order. */
const char *prop_front(const struct front *s)
{
    int64_t k = 0;
    while (k < s->n) {
        int32_t root[2], to[4096][2];
        struct from_roots u = {s, to, 4096, 0};
        climb(&s->in.tree, s->pair[k], root);
        from_root(&u, root[0], root[1]);
        EXPECT(k + u.n <= s->n);
        for (int64_t i = 0; i < u.n && i < u.cap; i++) {
            EXPECT(s->pair[k + i][0] == to[i][0]);
            EXPECT(s->pair[k + i][1] == to[i][1]);
        }
        k += u.n;
    }
    return NULL;
}
