/* SPDX-License-Identifier: Apache-2.0 */
/* Turns triangle pairs into vertex-face and edge-edge candidates, each exactly
 * once. spec/broad/features.md */
#include "ref/broad/features.h"

#include "ref/broad/bvtt.h"

/* Numbers of the 15 feature pairs of triangles f and g, §1: 0–2 are vertex of f
 * and face g, 3–5 vertex of g and face f, 6 + 3 i + j edge i of f and edge j of
 * g. */
enum { VF_BITS = 6 };

static bool has_vertex(const int32_t f[3], int32_t v)
{
    return f[0] == v || f[1] == v || f[2] == v;
}

/* One triangle of a triangle pair. */
struct side {
    const int32_t *v;
    int own; /* bits as in tree.own */
    struct box face;
};

static bool pair_moves(const struct features *s, int32_t a, int32_t b)
{
    return s->n_moved == 0 || (s->moved[a] | s->moved[b]);
}

/* §5: whether vertices a and b are sewn together. */
static bool are_sewn(const struct features *s, int32_t a, int32_t b)
{
    for (int32_t k = s->start[a]; k < s->start[a + 1]; k++)
        if (s->sewn[k] == b)
            return true;
    return false;
}

/* §5: whether one of n vertices a is sewn to one of m vertices b. */
static bool is_sewn(const struct features *s, int n, const int32_t *a, int m,
                    const int32_t *b)
{
    bool sewn = false;
    for (int i = 0; i < n && s->n_start > 0; i++)
        for (int j = 0; j < m && s->start[a[i]] < s->start[a[i] + 1]; j++)
            sewn |= are_sewn(s, a[i], b[j]);
    return sewn;
}

/* Tests the vertices of f against face g. Bit k of the result is set if vertex
 * k of f and face g are a candidate. */
static int test_vertices(const struct features *s, real reach,
                         const struct side *f, const struct side *g)
{
    int mask = 0;
    for (int k = 0; k < 3; k++) {
        int32_t v = f->v[k];
        if (!(f->own >> k & 1) || has_vertex(g->v, v))
            continue;
        struct box b = box_vertex(s->x0, s->x1, v);
        if (box_meets(&b, &g->face, reach) &&
            (pair_moves(s, v, g->v[0]) || pair_moves(s, g->v[1], g->v[2])) &&
            !is_sewn(s, 1, &v, 3, g->v))
            mask |= 1 << k;
    }
    return mask;
}

/* Tests the edges of f against the edges of g. Bit 3 i + j of the result is
 * set if edge i of f and edge j of g are a candidate. An edge whose box does
 * not meet the other face's box meets none of its edges, as they lie in that
 * box. */
static int test_edges(const struct features *s, real reach,
                      const struct side *f, const struct side *g)
{
    int mask = 0;
    for (int i = 0; i < 3; i++) {
        int32_t a = f->v[i], b = f->v[(i + 1) % 3];
        const int32_t one[2] = {a, b};
        if (!(f->own >> (3 + i) & 1))
            continue;
        struct box e = box_edge(s->x0, s->x1, a, b);
        if (!box_meets(&e, &g->face, reach))
            continue;
        for (int j = 0; j < 3; j++) {
            int32_t c = g->v[j], d = g->v[(j + 1) % 3];
            if (!(g->own >> (3 + j) & 1) || a == c || a == d || b == c ||
                b == d)
                continue;
            struct box h = box_edge(s->x0, s->x1, c, d);
            const int32_t other[2] = {c, d};
            if (box_meets(&e, &h, reach) &&
                (pair_moves(s, a, b) || pair_moves(s, c, d)) &&
                !is_sewn(s, 2, one, 2, other))
                mask |= 1 << (3 * i + j);
        }
    }
    return mask;
}

static uint16_t test_pair(const struct features *s, real reach, int64_t n)
{
    int32_t tf = s->both[n][0], tg = s->both[n][1];
    struct side f = {.v = s->tri[tf], .own = s->own[tf]};
    struct side g = {.v = s->tri[tg], .own = s->own[tg]};
    if (!(f.own | g.own))
        return 0;
    f.face = box_face(s->x0, s->x1, f.v);
    g.face = box_face(s->x0, s->x1, g.v);
    return (uint16_t)(test_vertices(s, reach, &f, &g) |
                      test_vertices(s, reach, &g, &f) << 3 |
                      test_edges(s, reach, &f, &g) << VF_BITS);
}

static void swap_ints(int32_t *a, int32_t *b)
{
    int32_t c = *a;
    *a = *b;
    *b = c;
}

/* §3: puts the smaller vertex of each edge first, then the edge with the
 * smaller first vertex. */
static void order_edges(int32_t e[4])
{
    if (e[0] > e[1])
        swap_ints(&e[0], &e[1]);
    if (e[2] > e[3])
        swap_ints(&e[2], &e[3]);
    if (e[0] > e[2]) { /* e[0] ≠ e[2]: no vertex is shared */
        swap_ints(&e[0], &e[2]);
        swap_ints(&e[1], &e[3]);
    }
}

/* Writes the four vertices of feature pair k. */
static void make_feature(const int32_t f[3], const int32_t g[3], int k,
                         int32_t to[4])
{
    if (k < VF_BITS) {
        const int32_t *face = k < 3 ? g : f;
        to[0] = k < 3 ? f[k] : g[k - 3];
        to[1] = face[0];
        to[2] = face[1];
        to[3] = face[2];
        return;
    }
    int i = (k - VF_BITS) / 3, j = (k - VF_BITS) % 3;
    to[0] = f[i];
    to[1] = f[(i + 1) % 3];
    to[2] = g[j];
    to[3] = g[(j + 1) % 3];
    order_edges(to);
}

static void emit_features(const struct features *s, int64_t n, int64_t *vf,
                          int64_t *ee)
{
    for (int k = 0; s->mask[n] >> k; k++) {
        if (!(s->mask[n] >> k & 1))
            continue;
        int64_t at = k < VF_BITS ? (*vf)++ : (*ee)++;
        make_feature(s->tri[s->both[n][0]], s->tri[s->both[n][1]], k,
                     s->pair[at]);
        s->kind[at] = k < VF_BITS ? FEATURES_VF : FEATURES_EE;
    }
}

int ref_features(struct features *s)
{
    int64_t blocks = bvtt_blocks(s->n);
    real reach = box_reach(s->r);
    s->n_pair = s->n_vf = 0;
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    EACH_MANY(s->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, vf = 0, all = 0;
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++) {
            s->mask[k] = test_pair(s, reach, k);
            vf += bvtt_bits(s->mask[k] & ((1 << VF_BITS) - 1));
            all += bvtt_bits(s->mask[k]);
        }
        s->sum[block] = vf;
        s->sum[blocks + block] = all - vf;
    }
    int64_t n_vf = bvtt_scan(s->sum, blocks);
    s->need = n_vf + bvtt_scan(s->sum + blocks, blocks);
    if (s->need > s->cap)
        return DRAPE_EFULL;
    EACH_MANY(s->n)
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK;
        int64_t vf = s->sum[block], ee = n_vf + s->sum[blocks + block];
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++)
            emit_features(s, k, &vf, &ee);
    }
    s->n_pair = s->need;
    s->n_vf = n_vf;
    return DRAPE_OK;
}
