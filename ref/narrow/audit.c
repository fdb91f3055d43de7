/* SPDX-License-Identifier: Apache-2.0 */
/* Finds every intersecting pair of triangles of a mesh, exactly, with a BVH of
 * its own. spec/narrow/audit.md */
#include "ref/narrow/audit.h"

#include "ref/narrow/audit_sort.h"
#include "ref/narrow/tritri.h"

/* Highest number of levels of the 4-ary tree over 2^31 triangles. */
enum { LEVELS = 17 };

/* §4.2: places of the tree's levels. Level l has ceil(nt / 4^(l+1)) nodes, from
 * at[l] on; `top` is the root's level. */
struct levels {
    int64_t at[LEVELS + 1];
    int top;
};

static struct levels levels_of(int64_t nt)
{
    struct levels r = {{0}, 0};
    int64_t n = (nt + 3) / 4;
    r.at[1] = n;
    for (; n > 1; r.top++) {
        n = (n + 3) / 4;
        r.at[r.top + 2] = r.at[r.top + 1] + n;
    }
    return r;
}

int64_t ref_audit_nodes(int64_t nt)
{
    struct levels l = levels_of(nt);
    return l.at[l.top + 1];
}

static int check_input(const struct audit *s)
{
    for (int64_t k = 0; k < s->nv; k++)
        if (!vec_sane(s->x[k]))
            return DRAPE_EDATA;
    for (int64_t k = 0; k < s->nt; k++)
        for (int j = 0; j < 3; j++)
            if (s->tri[k][j] < 0 || s->tri[k][j] >= s->nv)
                return DRAPE_EARG;
    return DRAPE_OK;
}

struct face ref_audit_face(const struct audit *s, int32_t t)
{
    struct face f;
    for (int j = 0; j < 3; j++) {
        f.v[j] = s->tri[t][j];
        vec x = s->x[f.v[j]];
        f.p[j][0] = (double)x.x;
        f.p[j][1] = (double)x.y;
        f.p[j][2] = (double)x.z;
    }
    return f;
}

static void put_box(struct audit_quad *q, int j, struct audit_box b)
{
    q->lo[0][j] = b.lo.x;
    q->lo[1][j] = b.lo.y;
    q->lo[2][j] = b.lo.z;
    q->hi[0][j] = b.hi.x;
    q->hi[1][j] = b.hi.y;
    q->hi[2][j] = b.hi.z;
}

static struct audit_box box_of_lane(const struct audit_quad *q, int j)
{
    struct audit_box b = {vec_make(q->lo[0][j], q->lo[1][j], q->lo[2][j]),
                          vec_make(q->hi[0][j], q->hi[1][j], q->hi[2][j])};
    return b;
}

/* Returns the box that joins the four boxes of a node. */
static struct audit_box join_boxes(const struct audit_quad *q)
{
    struct audit_box r = box_of_lane(q, 0);
    for (int j = 1; j < 4; j++) {
        struct audit_box b = box_of_lane(q, j);
        r.lo = vec_min(r.lo, b.lo);
        r.hi = vec_max(r.hi, b.hi);
    }
    return r;
}

static void build_levels(struct audit *s, const struct levels *l)
{
    const struct audit_box none = {vec_make(REAL_BIG, REAL_BIG, REAL_BIG),
                                   vec_make(-REAL_BIG, -REAL_BIG, -REAL_BIG)};
    EACH_ITEM
    for (int64_t k = 0; k < l->at[1]; k++)
        for (int j = 0; j < 4; j++)
            put_box(&s->node[k], j,
                    4 * k + j < s->nt
                        ? ref_audit_box(s->x, s->tri[s->order[0][4 * k + j]])
                        : none);
    for (int level = 1; level <= l->top; level++) {
        int64_t from = l->at[level - 1], n = l->at[level] - from;
        EACH_ITEM
        for (int64_t k = l->at[level]; k < l->at[level + 1]; k++)
            for (int j = 0; j < 4; j++) {
                int64_t child = 4 * (k - l->at[level]) + j;
                put_box(&s->node[k], j,
                        child < n ? join_boxes(&s->node[from + child]) : none);
            }
    }
}

/* Returns a mask: bit j is set if box b and the j-th box of q have a common
 * point. */
static unsigned meeting_mask(const struct audit_box *b,
                             const struct audit_quad *q)
{
    unsigned hit[4];
    for (int j = 0; j < 4; j++)
        hit[j] = (q->lo[0][j] <= b->hi.x) & (b->lo.x <= q->hi[0][j]) &
                 (q->lo[1][j] <= b->hi.y) & (b->lo.y <= q->hi[1][j]) &
                 (q->lo[2][j] <= b->hi.z) & (b->lo.z <= q->hi[2][j]);
    return hit[0] | hit[1] << 1 | hit[2] << 2 | hit[3] << 3;
}

static int lowest_bit(unsigned mask)
{
    return mask & 3 ? !(mask & 1) : 3 - !!(mask & 4);
}

/* §4.3: a traversal that finds the pairs of one leaf. */
struct walk {
    struct audit *s;
    int64_t k;            /* the leaf */
    int64_t n0;           /* triangles of group 0; they are sorted first */
    struct audit_box box; /* box of the leaf */
    int64_t at;           /* place of the next pair */
    bool write;           /* false: only count pairs */
};

static void emit_pair(struct walk *w, int32_t p, int32_t q)
{
    if (w->write) {
        w->s->pair[w->at][0] = p < q ? p : q;
        w->s->pair[w->at][1] = p < q ? q : p;
    }
    w->at++;
}

/* Tests the triangles of leaf w->k against those of leaf m ≥ w->k, each pair
 * once. */
static void visit_leaf(struct walk *w, int64_t m)
{
    const struct audit *s = w->s;
    for (int64_t i = 4 * w->k; i < 4 * w->k + 4 && i < s->nt; i++) {
        struct audit_box b = box_of_lane(&s->node[w->k], (int)(i % 4));
        unsigned mask = meeting_mask(&b, &s->node[m]);
        int32_t p = s->order[0][i];
        if (mask == 0 || s->degenerate[p] || (s->across && i >= w->n0))
            continue;
        struct face f = ref_audit_face(s, p);
        struct plane of_f = ref_plane(&f);
        for (; mask != 0; mask &= mask - 1) {
            int64_t j = 4 * m + lowest_bit(mask);
            int32_t q = s->order[0][j];
            if (j <= i || j < w->n0 || s->degenerate[q])
                continue;
            struct face g = ref_audit_face(s, q);
            if (ref_tritri(&f, &of_f, &g))
                emit_pair(w, p, q);
        }
    }
}

/* Visits all leaves from w->k on whose boxes meet the box of leaf w->k. */
static void visit_leaves(struct walk *w, const struct levels *l)
{
    struct audit *s = w->s;
    int64_t first = w->k > w->n0 / 4 ? w->k : w->n0 / 4;
    int64_t node[LEVELS] = {0};
    unsigned mask[LEVELS];
    int level = l->top;
    int64_t span = 1; /* leaves below a child of a node of this level */
    for (int k = 1; k < level; k++)
        span *= 4;
    w->box = join_boxes(&s->node[w->k]);
    mask[level] = meeting_mask(&w->box, &s->node[l->at[level]]);
    if (level == 0)
        visit_leaf(w, 0);
    while (level > 0 && level <= l->top) {
        if (mask[level] == 0) {
            level++;
            span *= 4;
            continue;
        }
        int64_t child = 4 * node[level] + lowest_bit(mask[level]);
        mask[level] &= mask[level] - 1;
        if ((child + 1) * span <= first)
            continue;
        if (level == 1) {
            visit_leaf(w, child);
            continue;
        }
        level--;
        span /= 4;
        node[level] = child;
        mask[level] = meeting_mask(&w->box, &s->node[l->at[level] + child]);
    }
}

/* §1.1: marks and counts degenerate triangles. Returns the number of triangles
 * of group 0. */
static int64_t mark_degenerate(struct audit *s)
{
    EACH_ITEM
    for (int64_t t = 0; t < s->nt; t++) {
        struct face f = ref_audit_face(s, (int32_t)t);
        s->degenerate[t] = ref_collinear(&f);
    }
    int64_t n0 = 0;
    for (int64_t t = 0; t < s->nt; t++) {
        s->n_degenerate += s->degenerate[t];
        n0 += s->group != NULL && s->group[t] == 0;
    }
    return n0;
}

int ref_audit(struct audit *s)
{
    s->found = s->n_degenerate = 0;
    int status = check_input(s);
    if (status != DRAPE_OK || s->nt == 0)
        return status;
    int64_t n0 = mark_degenerate(s);
    struct levels l = levels_of(s->nt);
    const struct audit_order order = {s->nv,    s->nt,  s->x,    s->tri,
                                      s->group, s->key, s->order};
    ref_audit_order(&order);
    build_levels(s, &l);
    EACH_ITEM
    for (int64_t k = 0; k < l.at[1]; k++) {
        struct walk w = {.s = s, .k = k, .n0 = n0};
        visit_leaves(&w, &l);
        s->count[k] = w.at;
    }
    for (int64_t k = 0; k < l.at[1]; k++)
        s->found += s->count[k];
    if (s->found > s->cap)
        return DRAPE_EFULL;
    for (int64_t k = 0, at = 0; k < l.at[1]; at += s->count[k], k++)
        if (s->count[k] > 0) {
            struct walk w = {.s = s, .k = k, .n0 = n0, .at = at, .write = true};
            visit_leaves(&w, &l);
        }
    ref_audit_sort(s->pair, s->found);
    return DRAPE_OK;
}

/* §5: a traversal that visits every triangle whose box meets the box of
 * triangle t. */
struct search {
    const struct audit *s;
    struct levels l;
    struct audit_box box;
    int32_t t;
    bool (*ask)(void *user, int32_t other);
    void *user;
};

static bool search_tree(const struct search *r, int level, int64_t node)
{
    const struct audit *s = r->s;
    unsigned mask = meeting_mask(&r->box, &s->node[r->l.at[level] + node]);
    for (; mask != 0; mask &= mask - 1) {
        int64_t child = 4 * node + lowest_bit(mask);
        if (level > 0) {
            if (search_tree(r, level - 1, child))
                return true;
        } else if (child < s->nt && s->order[0][child] != r->t &&
                   r->ask(r->user, s->order[0][child])) {
            return true;
        }
    }
    return false;
}

bool ref_audit_any(const struct audit *s, int32_t t,
                   bool ask(void *user, int32_t other), void *user)
{
    struct search r = {.s = s,
                       .l = levels_of(s->nt),
                       .box = ref_audit_box(s->x, s->tri[t]),
                       .t = t,
                       .ask = ask,
                       .user = user};
    return search_tree(&r, r.l.top, 0);
}
