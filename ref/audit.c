/* SPDX-License-Identifier: Apache-2.0 */
/* Every intersecting pair of triangles of a mesh. spec/40_audit.md */
#include "ref/audit.h"

#include "ref/tritri.h"

/* Triangles of a leaf, and most levels of the tree over 2^31 of them. */
enum { LEAF = 4, LEVELS = 32 };

/* §4.2: level l holds ceil(leaves / 2^l) nodes from at[l] on. */
struct levels {
    int64_t at[LEVELS], leaves;
    int top;
};

static struct levels levels_of(int64_t nt)
{
    struct levels r = {.leaves = (nt + LEAF - 1) / LEAF};
    int64_t n = r.leaves;
    while (n > 1) {
        r.at[r.top + 1] = r.at[r.top] + n;
        r.top++;
        n = (n + 1) / 2;
    }
    return r;
}

int64_t ref_audit_nodes(int64_t nt)
{
    struct levels l = levels_of(nt);
    return nt > 0 ? l.at[l.top] + 1 : 0;
}

/* ---- §4.1 Order ---- */

static int check(const struct audit *s)
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

static void load(const struct audit *s, const int32_t v[3], point p[3])
{
    for (int j = 0; j < 3; j++) {
        vec x = s->x[v[j]];
        p[j][0] = (double)x.x;
        p[j][1] = (double)x.y;
        p[j][2] = (double)x.z;
    }
}

static struct audit_box box_of(const struct audit *s, int64_t t)
{
    const int32_t *v = s->tri[t];
    vec a = s->x[v[0]], b = s->x[v[1]], c = s->x[v[2]];
    struct audit_box r = {vec_min(vec_min(a, b), c), vec_max(vec_max(a, b), c),
                          1};
    if (s->group == NULL || s->group[t] != 0)
        r.groups = 2;
    return r;
}

static struct audit_box unite(struct audit_box a, struct audit_box b)
{
    struct audit_box r = {vec_min(a.lo, b.lo), vec_max(a.hi, b.hi),
                          a.groups | b.groups};
    return r;
}

/* The low 21 bits, two zeros between each. */
static uint64_t spread(uint64_t b)
{
    b = (b | b << 32) & UINT64_C(0x001f00000000ffff);
    b = (b | b << 16) & UINT64_C(0x001f0000ff0000ff);
    b = (b | b << 8) & UINT64_C(0x100f00f00f00f00f);
    b = (b | b << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (b | b << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t cell(real lo, real hi, real from, real size)
{
    real c = lo + (hi - lo) * R(0.5);
    return size > 0 ? (uint64_t)((c - from) / size * R(2097151.0)) : 0;
}

static void make_keys(struct audit *s)
{
    struct audit_box all = s->box[0];
    for (int64_t t = 1; t < s->nt; t++)
        all = unite(all, s->box[t]);
    vec d = vec_sub(all.hi, all.lo);
    real size = real_max(real_max(d.x, d.y), d.z);
    EACH_ITEM
    for (int64_t t = 0; t < s->nt; t++) {
        struct audit_box b = s->box[t];
        s->key[0][t] = spread(cell(b.lo.x, b.hi.x, all.lo.x, size)) |
                       spread(cell(b.lo.y, b.hi.y, all.lo.y, size)) << 1 |
                       spread(cell(b.lo.z, b.hi.z, all.lo.z, size)) << 2;
        s->order[0][t] = (int32_t)t;
    }
}

/* Stable, by the 11 bits from `shift` on, from side `from` to the other;
 * false where these bits are the same in all keys. */
static bool sort_digit(struct audit *s, int from, int shift)
{
    int64_t at[2049] = {0};
    const uint64_t *key = s->key[from];
    for (int64_t t = 0; t < s->nt; t++)
        at[(key[t] >> shift & 2047) + 1]++;
    for (int k = 0; k < 2048; k++) {
        if (at[k + 1] == s->nt)
            return false;
        at[k + 1] += at[k];
    }
    for (int64_t t = 0; t < s->nt; t++) {
        int64_t to = at[key[t] >> shift & 2047]++;
        s->key[!from][to] = key[t];
        s->order[!from][to] = s->order[from][t];
    }
    return true;
}

/* Order[0] along a Morton curve through the boxes' middles. */
static void sort_triangles(struct audit *s)
{
    make_keys(s);
    int from = 0;
    for (int shift = 0; shift < 63; shift += 11)
        if (sort_digit(s, from, shift))
            from = !from;
    if (from == 1)
        for (int64_t t = 0; t < s->nt; t++)
            s->order[0][t] = s->order[1][t];
}

/* ---- §4.2 Tree ---- */

static void build(struct audit *s, const struct levels *l)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->nt; k++)
        s->box[k] = box_of(s, s->order[0][k]);
    EACH_ITEM
    for (int64_t k = 0; k < l->leaves; k++) {
        struct audit_box b = s->box[LEAF * k];
        for (int64_t t = LEAF * k + 1; t < LEAF * k + LEAF && t < s->nt; t++)
            b = unite(b, s->box[t]);
        s->node[k] = b;
    }
    int64_t below = l->leaves;
    for (int level = 1; level <= l->top; level++) {
        const struct audit_box *from = s->node + l->at[level - 1];
        struct audit_box *to = s->node + l->at[level];
        int64_t n = (below + 1) / 2;
        EACH_ITEM
        for (int64_t k = 0; k < n; k++)
            to[k] = 2 * k + 1 < below ? unite(from[2 * k], from[2 * k + 1])
                                      : from[2 * k];
        below = n;
    }
}

/* Closed boxes with a common point, not both of group 0 alone. */
static bool near(const struct audit_box *a, const struct audit_box *b)
{
    return (a->lo.x <= b->hi.x) & (b->lo.x <= a->hi.x) &
           (a->lo.y <= b->hi.y) & (b->lo.y <= a->hi.y) &
           (a->lo.z <= b->hi.z) & (b->lo.z <= a->hi.z) &
           ((a->groups | b->groups) != 1);
}

/* ---- §4.3 Pairs ---- */

static bool intersect(const struct audit *s, int32_t a, int32_t b)
{
    int32_t v[2][3];
    for (int j = 0; j < 3; j++) {
        v[0][j] = s->tri[a][j];
        v[1][j] = s->tri[b][j];
    }
    int shared = ref_align(v[0], v[1]);
    point p[3], q[3];
    load(s, v[0], p);
    load(s, v[1], q);
    return ref_tritri((const double(*)[3])p, (const double(*)[3])q, shared);
}

/* Pairs of one triangle of leaf k with one of leaf m ≥ k, each once; written
 * from *at on where `write`. */
static void visit(struct audit *s, int64_t k, int64_t m, int64_t *at,
                  bool write)
{
    int64_t end_i = LEAF * k + LEAF < s->nt ? LEAF * k + LEAF : s->nt;
    int64_t end_j = LEAF * m + LEAF < s->nt ? LEAF * m + LEAF : s->nt;
    for (int64_t i = LEAF * k; i < end_i; i++)
        for (int64_t j = k == m ? i + 1 : LEAF * m; j < end_j; j++) {
            int32_t a = s->order[0][i], b = s->order[0][j];
            if (!near(&s->box[i], &s->box[j]) || s->degenerate[a] ||
                s->degenerate[b] || !intersect(s, a, b))
                continue;
            if (write) {
                s->pair[*at][0] = a < b ? a : b;
                s->pair[*at][1] = a < b ? b : a;
            }
            ++*at;
        }
}

/* Walks the tree from leaf k on, in leaf order, without a stack. */
static int64_t walk(struct audit *s, const struct levels *l, int64_t k,
                    int64_t at)
{
    bool write = at >= 0;
    int64_t n = write ? at : 0, m = k;
    int level = 0;
    while (m << level < l->leaves) {
        bool hit = near(&s->node[k], &s->node[l->at[level] + m]);
        if (hit && level > 0) {
            level--;
            m *= 2;
            continue;
        }
        if (hit)
            visit(s, k, m, &n, write);
        m++;
        while (m % 2 == 0 && level < l->top) {
            m /= 2;
            level++;
        }
    }
    return n;
}

/* ---- §4.4 Canonical order ---- */

static bool before(const int32_t a[2], const int32_t b[2])
{
    return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]);
}

static void swap(int32_t a[2], int32_t b[2])
{
    for (int j = 0; j < 2; j++) {
        int32_t v = a[j];
        a[j] = b[j];
        b[j] = v;
    }
}

static void sift(int32_t (*p)[2], int64_t k, int64_t n)
{
    for (int64_t c = 2 * k + 1; c < n; k = c, c = 2 * k + 1) {
        if (c + 1 < n && before(p[c], p[c + 1]))
            c++;
        if (!before(p[k], p[c]))
            return;
        swap(p[k], p[c]);
    }
}

static void sort_pairs(int32_t (*p)[2], int64_t n)
{
    for (int64_t k = n / 2; k-- > 0;)
        sift(p, k, n);
    while (n-- > 1) {
        swap(p[0], p[n]);
        sift(p, 0, n);
    }
}

int ref_audit(struct audit *s)
{
    s->found = s->n_degenerate = 0;
    int status = check(s);
    if (status != DRAPE_OK || s->nt == 0)
        return status;
    EACH_ITEM
    for (int64_t t = 0; t < s->nt; t++) {
        point p[3];
        load(s, s->tri[t], p);
        s->degenerate[t] = ref_collinear((const double(*)[3])p);
        s->box[t] = box_of(s, t);
    }
    for (int64_t t = 0; t < s->nt; t++)
        s->n_degenerate += s->degenerate[t];

    struct levels l = levels_of(s->nt);
    sort_triangles(s);
    build(s, &l);
    EACH_ITEM
    for (int64_t k = 0; k < l.leaves; k++)
        s->count[k] = walk(s, &l, k, -1);
    for (int64_t k = 0; k < l.leaves; k++)
        s->found += s->count[k];
    if (s->found > s->cap)
        return DRAPE_EFULL;
    for (int64_t k = 0, at = 0; k < l.leaves; at += s->count[k], k++)
        if (s->count[k] > 0)
            walk(s, &l, k, at);
    sort_pairs(s->pair, s->found);
    return DRAPE_OK;
}
