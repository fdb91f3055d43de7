/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a contact of each new impact and merges it into the active set.
 * spec/contact/impulses.md */
#include "ref/contact/impulses.h"

#include "ref/narrow/closest.h"

static int check_input(const struct impulses *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->margin >= 0) ||
        s->n_all != s->n + s->n_active || s->n_all > INT32_MAX / 4)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv) || s->kind[k] > CONTACT_EE)
            return DRAPE_EARG;
    return DRAPE_OK;
}

/* §1: keys */

static uint64_t join_words(int32_t a, int32_t b)
{
    return (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
}

static uint64_t edge_word(int32_t a, int32_t b)
{
    return a < b ? join_words(a, b) : join_words(b, a);
}

struct key impulses_key(const int32_t v[4], int64_t kind, int64_t item)
{
    if (kind == CONTACT_EE) {
        uint64_t a = edge_word(v[0], v[1]), b = edge_word(v[2], v[3]);
        uint64_t first = a < b ? a : b, second = a < b ? b : a;
        return (struct key){first | UINT64_C(1) << 63, second, item};
    }
    int32_t a = v[1], b = v[2], c = v[3];
    int32_t lo = a < b ? a : b, hi = a < b ? b : a;
    int32_t least = c < lo ? c : lo, most = c > hi ? c : hi;
    int32_t middle = c < lo ? lo : c > hi ? hi : c;
    return (struct key){join_words(v[0], least), join_words(middle, most),
                        item};
}

/* §2: geometry */

struct impact {
    struct wide x[4];    /* m, at the impact, relative to x0[v[0]] */
    struct wide from[4]; /* m, at the start, likewise */
    struct wide way[4];  /* m, displacement over the step */
};

static void place_vertices(const struct impulses *s, const int32_t v[4],
                           double t, struct impact *m)
{
    struct wide base = wide_of(s->x0[v[0]]);
    for (int k = 0; k < 4; k++) {
        struct wide a = wide_of(s->x0[v[k]]);
        m->way[k] = wide_sub(wide_of(s->x1[v[k]]), a);
        m->from[k] = wide_sub(a, base);
    }
    for (int k = 0; k < 4; k++)
        m->x[k] = wide_axpy(m->from[k], t, m->way[k]);
}

static struct wide weighted_sum(const double c[4], const struct wide a[4])
{
    struct wide r = wide_scale(c[0], a[0]);
    for (int k = 1; k < 4; k++)
        r = wide_axpy(r, c[k], a[k]);
    return r;
}

/* The primitives' own normal, with the sign that opposes the approach; or
 * opposite to the approach where that normal is almost across it. */
static struct wide own_normal(const struct impact *m, int64_t kind,
                              const struct closest *r)
{
    struct wide way = weighted_sum(r->c, m->way),
                from = weighted_sum(r->c, m->from);
    struct wide back = closest_unit(wide_scale(-1, way),
                                    closest_unit(from, wide_make(1, 0, 0)));
    struct wide n = closest_unit(closest_normal(m->x, (int)kind), back);
    double closing = wide_dot(n, way);
    if (closing * closing <= 0x1p-32 * wide_dot(way, way))
        return back;
    return closing > 0 ? wide_scale(-1, n) : n;
}

/* §2.3: n, or where it is no normal of the prescribed side's surface, the
 * normal of the triangle there that it is most along. */
static struct wide surface_normal(const struct impulses *s, int64_t k,
                                  const struct impact *m,
                                  const struct closest *r, struct wide n)
{
    const int32_t *v = s->pair + 4 * k;
    int kind = s->kind[k], side = prescribed_side(kind, v, s->w);
    if (side == SIDES)
        return n;
    struct places places = {s->x0, s->x1, (double)s->toi[k] * 0x1p-30};
    struct closest_point f = closest_point_find(
        v, side_start(kind, side), side_start(kind, side + 1), m->x, r->c,
        side == SIDE_A ? wide_scale(-1, n) : n);
    struct wide t = f.p;
    if (closest_point_is_local(&places, &s->one_rings, &f,
                               CLOSEST_PRESCRIBED) ||
        !closest_point_normal(&places, &s->one_rings, &f, 0, &t))
        return n;
    if (side == SIDE_A)
        t = wide_scale(-1, t);
    bool good = wide_dot(t, weighted_sum(r->c, m->way)) <= 0 &&
                wide_dot(t, weighted_sum(r->c, m->from)) >= 0;
    return good ? t : n;
}

/* §2: the closest points of impact k when it touches, and its normal. */
static struct wide find_normal(const struct impulses *s, int64_t k,
                               struct impact *m, struct closest *r)
{
    place_vertices(s, s->pair + 4 * k, (double)s->toi[k] * 0x1p-30, m);
    if (s->kind[k] == CONTACT_VF)
        closest_vf(m->x, r);
    else
        closest_ee(m->x, r);
    return surface_normal(s, k, m, r, own_normal(m, s->kind[k], r));
}

static void emit_contact(const struct impulses *s, int64_t k, struct contact *c)
{
    struct impact m;
    struct closest r;
    memcpy(c->v, s->pair + 4 * k, sizeof c->v);
    c->kind = s->kind[k];
    struct wide n = find_normal(s, k, &m, &r);
    struct surface surface = surfaces_pair(&s->surfaces, c->v);
    closest_weights(&r, (int)c->kind, c->c);
    c->n = wide_round(n);
    c->gap = (real)wide_dot(n, weighted_sum(r.c, m.from));
    c->target = (s->margin * surface.thickness - c->gap) / s->dt;
    c->friction = surface.friction;
    contact_clear(c);
}

/* §5: the first impact of each vertex */

static const uint64_t NONE = ~UINT64_C(0);

/* Finds the first impact of each free vertex of the impacts. The order of time
 * is total: of those at the same toi the one that is listed first counts. */
static void find_first(struct impulses *s)
{
    for (int64_t k = 0; k < 4 * s->n; k++)
        s->first[s->pair[k]] = NONE;
    for (int64_t k = 0; k < 4 * s->n; k++) {
        int32_t i = s->pair[k];
        uint64_t time = (uint64_t)s->toi[k / 4] << 32 | (uint64_t)(k / 4);
        if (s->w[i] > 0 && time < s->first[i])
            s->first[i] = time;
    }
}

/* The direction in which impact k pushes its side A. */
static struct wide aim_of(const struct impulses *s, int64_t k)
{
    struct impact m;
    struct closest r;
    return find_normal(s, k, &m, &r);
}

/* Whether vertex i, one of its four, is on side A of impact k. */
static bool on_side_a(const struct impulses *s, int64_t k, int32_t i)
{
    const int32_t *v = s->pair + 4 * k;
    return v[0] == i || (s->kind[k] == CONTACT_EE && v[1] == i);
}

/* Whether impact k pushes a free vertex of its against what this vertex met
 * before. */
static bool is_shadowed(const struct impulses *s, int64_t k)
{
    struct wide aim = aim_of(s, k);
    for (int j = 0; j < 4; j++) {
        int32_t i = s->pair[4 * k + j];
        if (!(s->w[i] > 0) || s->first[i] >> 32 >= s->toi[k])
            continue;
        int64_t before = (int64_t)(s->first[i] & UINT32_MAX);
        double along = wide_dot(aim, aim_of(s, before));
        if (on_side_a(s, k, i) != on_side_a(s, before, i))
            along = -along;
        if (along < 0)
            return true;
    }
    return false;
}

/* The key of impact k: its pair's, or one behind all others if it is left to a
 * later round. */
static struct key key_of(const struct impulses *s, int64_t k)
{
    if (is_shadowed(s, k))
        return (struct key){NONE, NONE, s->n_active + k};
    return impulses_key(s->pair + 4 * k, s->kind[k], s->n_active + k);
}

static bool is_same_key(const struct key *a, const struct key *b)
{
    return a->hi == b->hi && a->lo == b->lo;
}

/* §1: κ of a pair that touches again. */
static real kappa_again(const struct impulses *s, const struct contact *c)
{
    bool yields = c->impulse > 0 && c->kappa < s->stiffest;
    return yields ? real_min(c->kappa / CONTACT_GIVE, s->stiffest) : c->kappa;
}

/* §1: the contact of a pair that the active set has as well goes on with its
 * multipliers. */
static void inherit_multipliers(const struct impulses *s,
                                const struct contact *from, struct contact *c)
{
    real order = from->v[0] == c->v[0] || from->v[0] == c->v[1] ? 1 : -1;
    vec t = vec_scale(c->kind == CONTACT_VF ? 1 : order, from->lambda_t);
    c->lambda = from->lambda;
    c->lambda_t = vec_axpy(t, -vec_dot(c->n, t), c->n);
    c->load = from->load;
    c->kappa = kappa_again(s, from);
    c->rise = from->rise;
}

/* §1: of equal keys the newest, which is the last, stays; before[k].item is the
 * contact of the active set whose place key[k] takes, or -1. */
static void merge_active(struct impulses *s, struct key *key,
                         struct key *before)
{
    s->found = 0;
    for (int64_t k = 0; k < s->n_all && key[k].hi != NONE; k++) {
        bool again = k > 0 && is_same_key(&key[k - 1], &key[k]);
        int64_t old = again ? key[k - 1].item : -1;
        if (k + 1 < s->n_all && is_same_key(&key[k], &key[k + 1]))
            continue;
        before[s->found].item = old < s->n_active ? old : -1;
        key[s->found++] = key[k];
    }
}

int ref_impulses(struct impulses *s)
{
    int status = check_input(s);
    if (status != DRAPE_OK)
        return status;
    find_first(s); /* §5 */
    EACH_ITEM
    for (int64_t k = 0; k < s->n_active; k++)
        s->key[k] = impulses_key(s->active[k].v, s->active[k].kind, k);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->key[s->n_active + k] = key_of(s, k);
    struct key *key = keys_sort(s->n_all, s->key, s->spare);
    struct key *before = key == s->key ? s->spare : s->key;
    merge_active(s, key, before);
    if (s->found > s->cap)
        return DRAPE_EFULL;

    EACH_ITEM
    for (int64_t k = 0; k < s->found; k++) {
        int64_t item = key[k].item;
        if (item < s->n_active) {
            s->contact[k] = s->active[item];
            continue;
        }
        emit_contact(s, item - s->n_active, &s->contact[k]);
        if (before[k].item >= 0)
            inherit_multipliers(s, &s->active[before[k].item], &s->contact[k]);
    }
    return DRAPE_OK;
}
