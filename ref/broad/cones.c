/* SPDX-License-Identifier: Apache-2.0 */
/* Proves which patches of cloth cannot touch themselves during a step, so that
 * front and walk can skip their pairs. spec/broad/cones.md */
#include "ref/broad/cones.h"

/* Safety margin of §3 in units of u. spec/proofs/cones_room.gappa proves that
 * it covers all roundings. */
#define CONES_ROOM 32

static struct tangents join_tangents(struct tangents a, struct tangents b)
{
    struct tangents c = {vec_min(a.ulo, b.ulo), vec_max(a.uhi, b.uhi),
                         vec_min(a.vlo, b.vlo), vec_max(a.vhi, b.vhi)};
    return c;
}

/* §2: bounds the tangents of a cell that has both its triangles. */
static struct tangents bound_cell(const struct cones *s, int32_t a)
{
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int32_t i = s->tree.place[a] & 0xffff, j = s->tree.place[a] >> 16;
    int32_t v = g->base + i + g->m * j, w = v + g->m;
    const vec *x[2] = {s->x0, s->x1};
    struct tangents b = {0};
    for (int k = 0; k < 2; k++) {
        vec u0 = vec_sub(x[k][v + 1], x[k][v]);
        vec u1 = vec_sub(x[k][w + 1], x[k][w]);
        vec v0 = vec_sub(x[k][w], x[k][v]);
        vec v1 = vec_sub(x[k][w + 1], x[k][v + 1]);
        struct tangents c = {vec_min(u0, u1), vec_max(u0, u1), vec_min(v0, v1),
                             vec_max(v0, v1)};
        b = k ? join_tangents(b, c) : c;
    }
    return b;
}

/* Returns the tangent bounds of a full node. They are stored for inner nodes;
 * for a leaf they are computed here, as few leaves are read twice. */
static struct tangents tangents_of(const struct cones *s, int64_t a)
{
    int64_t leaves = s->tree.n_cloth - s->n_inner;
    return a < leaves ? bound_cell(s, (int32_t)a) : s->tangents[a - leaves];
}

static void fit_node(const struct cones *s, int64_t a)
{
    int32_t c = s->tree.first[a];
    if (!s->map.full[a] || !s->stir[a])
        return;
    struct tangents b = tangents_of(s, c);
    for (int k = 1; k < s->tree.count[a]; k++)
        b = join_tangents(b, tangents_of(s, c + k));
    s->tangents[a - (s->tree.n_cloth - s->n_inner)] = b;
}

/* The range of p·x for x in a box, and the sum of its largest terms, which
 * scales the error bound. */
struct span {
    real lo, hi, size;
};

static struct span span_axis(real p, real lo, real hi)
{
    real a = p * lo, b = p * hi;
    struct span s = {real_min(a, b), real_max(a, b),
                     real_max(real_abs(a), real_abs(b))};
    return s;
}

static struct span span_dot(vec p, vec lo, vec hi)
{
    struct span x = span_axis(p.x, lo.x, hi.x);
    struct span y = span_axis(p.y, lo.y, hi.y);
    struct span z = span_axis(p.z, lo.z, hi.z);
    struct span s = {(x.lo + y.lo) + z.lo, (x.hi + y.hi) + z.hi,
                     (x.size + y.size) + z.size};
    return s;
}

bool cones_apart(const struct tangents *b, real r)
{
    const real room = CONES_ROOM * REAL_UNIT, least = R(0x1p-100);
    vec u = vec_scale(R(0.5), vec_add(b->ulo, b->uhi));
    vec v = vec_scale(R(0.5), vec_add(b->vlo, b->vhi));
    real uu = vec_dot(u, u), uv = vec_dot(u, v), vv = vec_dot(v, v);
    real det = uu * vv - uv * uv;
    if (!(det > 0))
        return false;
    /* By §1 any pu and pv are valid. The dual basis of the box's middle makes a
     * and b about 1 and c about 0. */
    vec pu = vec_scale(1 / det, vec_sub(vec_scale(vv, u), vec_scale(uv, v)));
    vec pv = vec_scale(1 / det, vec_sub(vec_scale(uu, v), vec_scale(uv, u)));
    struct span a = span_dot(pu, b->ulo, b->uhi);
    struct span d = span_dot(pv, b->vlo, b->vhi);
    struct span e = span_dot(pu, b->vlo, b->vhi);
    struct span f = span_dot(pv, b->ulo, b->uhi);
    real norm = real_sqrt(vec_dot(pu, pu) + vec_dot(pv, pv));
    real mu = R(1.5) * r * norm * (1 + room) + least;
    real am = a.lo - (a.size * room + mu);
    real bm = d.lo - (d.size * room + mu);
    real c = R(0.5) * real_max(real_abs(e.lo + f.lo), real_abs(e.hi + f.hi));
    real cm = c + ((e.size + f.size) * room + least);
    return am > 0 && bm > 0 && am * bm > cm * cm;
}

/* Returns the node at offset (di, dj) from a on the same level, or -1. */
static int32_t find_neighbour(const struct cones *s, int32_t a, int di, int dj)
{
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int l = s->tree.level[a], unit = 1 << l;
    int32_t w = (g->m - 1 + unit - 1) >> l, h = (g->n - 1 + unit - 1) >> l;
    int32_t i = (s->tree.place[a] & 0xffff) + di;
    int32_t j = (s->tree.place[a] >> 16) + dj;
    if (i < 0 || j < 0 || i >= w || j >= h)
        return -1;
    return s->map.at[g->at[l] + i + w * j];
}

/* §4: whether the smallest rectangle of nodes that holds a and its neighbour at
 * offset (di, dj) is full and cannot touch itself. */
static bool patch_apart(const struct cones *s, int32_t a, int di, int dj)
{
    if (!s->map.full[a])
        return false;
    struct tangents b = tangents_of(s, a);
    for (int k = 1; k < 4; k++) {
        int i = k & 1 ? di : 0, j = k & 2 ? dj : 0;
        int32_t c = i || j ? find_neighbour(s, a, i, j) : a;
        if (c < 0 || !s->map.full[c])
            return false;
        b = join_tangents(b, tangents_of(s, c));
    }
    return cones_apart(&b, s->r);
}

/* §5: sets the bits of node a. A bit is set if the pair of parents is clear, or
 * if the test of §4 proves the pair clear. A pair of which neither node stirs
 * keeps its bit (§6). */
static void mark_clear(const struct cones *s, const struct bvtt *above,
                       int32_t a)
{
    static const int di[5] = {0, 1, 1, 0, -1}, dj[5] = {0, 0, 1, 1, 1};
    int32_t up = s->tree.parent[a];
    int bits = 0;
    for (int k = CLEAR_SELF; k <= CLEAR_NW; k++) {
        int32_t b = find_neighbour(s, a, di[k], dj[k]);
        if (b < 0)
            continue;
        if (!(s->stir[a] | s->stir[b]))
            bits |= s->clear[a] & 1 << k;
        else if ((up >= 0 && bvtt_clear(above, up, s->tree.parent[b])) ||
                 patch_apart(s, a, di[k], dj[k]))
            bits |= 1 << k;
    }
    s->clear[a] = (uint8_t)bits;
}

int ref_cones(struct cones *s)
{
    struct bvtt above = {.tree = s->tree, .clear = s->clear};
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    for (int64_t l = 1; l < s->tree.levels; l++) {
        const int32_t *run = s->tree.range + l;
        EACH_MANY(run[1] - run[0])
        for (int32_t a = run[0]; a < run[1]; a++)
            fit_node(s, a);
    }
    for (int64_t l = s->tree.levels - 1; l >= 0; l--) {
        const int32_t *run = s->tree.range + l;
        EACH_MANY(run[1] - run[0])
        for (int32_t a = run[0]; a < run[1]; a++)
            mark_clear(s, &above, a);
    }
    return DRAPE_OK;
}
