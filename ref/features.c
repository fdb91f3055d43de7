/* SPDX-License-Identifier: Apache-2.0 */
/* Vertex-face and edge-edge candidates of triangle pairs, each once.
 * spec/24_features.md */
#include "ref/features.h"

#include "ref/bvtt.h"

/* Feature pairs of triangles f and g by number, §1: 0–2 vertex of f and g,
 * 3–5 vertex of g and f, 6 + 3 i + j edge i of f and edge j of g. */
enum { VF_BITS = 6, ALL_BITS = 15 };

static bool has(const int32_t f[3], int32_t v)
{
    return f[0] == v || f[1] == v || f[2] == v;
}

/* The vertices of feature pair k; false where the triangles do not represent
 * it or a vertex is shared. */
static bool make(const struct features *s, const int32_t both[2], int k,
                 int32_t to[4])
{
    const int32_t *f = s->tri[both[0]], *g = s->tri[both[1]];
    int own_f = s->own[both[0]], own_g = s->own[both[1]];
    if (k < VF_BITS) {
        const int32_t *face = k < 3 ? g : f;
        to[0] = k < 3 ? f[k] : g[k - 3];
        to[1] = face[0];
        to[2] = face[1];
        to[3] = face[2];
        return (k < 3 ? own_f >> k : own_g >> (k - 3)) & 1 && !has(face, to[0]);
    }
    int i = (k - VF_BITS) / 3, j = (k - VF_BITS) % 3;
    to[0] = f[i];
    to[1] = f[(i + 1) % 3];
    to[2] = g[j];
    to[3] = g[(j + 1) % 3];
    return own_f >> (3 + i) & own_g >> (3 + j) & 1 && to[0] != to[2] &&
           to[0] != to[3] && to[1] != to[2] && to[1] != to[3];
}

static void swap(int32_t *a, int32_t *b)
{
    int32_t c = *a;
    *a = *b;
    *b = c;
}

/* §3: the smaller end of an edge first, the smaller edge first. */
static void order_edges(int32_t e[4])
{
    if (e[0] > e[1])
        swap(&e[0], &e[1]);
    if (e[2] > e[3])
        swap(&e[2], &e[3]);
    if (e[0] > e[2]) { /* they share no vertex, so e[0] ≠ e[2] */
        swap(&e[0], &e[2]);
        swap(&e[1], &e[3]);
    }
}

static bool moves(const struct features *s, const int32_t v[4])
{
    return s->n_moved == 0 ||
           (s->moved[v[0]] | s->moved[v[1]] | s->moved[v[2]] | s->moved[v[3]]);
}

static bool meets(const struct features *s, real reach, int k,
                  const int32_t v[4])
{
    struct box a, b;
    if (k < VF_BITS) {
        a = box_vertex(s->x0, s->x1, v[0]);
        b = box_face(s->x0, s->x1, v + 1);
    } else {
        a = box_edge(s->x0, s->x1, v[0], v[1]);
        b = box_edge(s->x0, s->x1, v[2], v[3]);
    }
    return box_meets(&a, &b, reach);
}

static uint16_t look(const struct features *s, real reach, int64_t n)
{
    int mask = 0;
    int32_t v[4];
    for (int k = 0; k < ALL_BITS; k++)
        if (make(s, s->both[n], k, v) && moves(s, v) && meets(s, reach, k, v))
            mask |= 1 << k;
    return (uint16_t)mask;
}

static void emit(const struct features *s, int64_t n, int64_t *vf, int64_t *ee)
{
    for (int k = 0; k < ALL_BITS; k++) {
        if (!(s->mask[n] >> k & 1))
            continue;
        int64_t at = k < VF_BITS ? (*vf)++ : (*ee)++;
        make(s, s->both[n], k, s->pair[at]);
        if (k >= VF_BITS)
            order_edges(s->pair[at]);
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
    EACH_ITEM
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK, vf = 0, all = 0;
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++) {
            s->mask[k] = look(s, reach, k);
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
    EACH_ITEM
    for (int64_t block = 0; block < blocks; block++) {
        int64_t end = (block + 1) * BVTT_BLOCK;
        int64_t vf = s->sum[block], ee = n_vf + s->sum[blocks + block];
        for (int64_t k = block * BVTT_BLOCK; k < s->n && k < end; k++)
            emit(s, k, &vf, &ee);
    }
    s->n_pair = s->need;
    s->n_vf = n_vf;
    return DRAPE_OK;
}
