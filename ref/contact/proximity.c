/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the candidates closer than their thickness and makes them contacts.
 * spec/contact/proximity.md */
#include "ref/contact/proximity.h"

#include "ref/narrow/closest.h"

static int check(const struct proximity *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->stiffness >= 0))
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv) || s->kind[k] > CONTACT_EE)
            return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        for (int j = 0; j < 4; j++)
            if (!vec_sane(s->x[s->pair[4 * k + j]]))
                return DRAPE_EDATA;
    return DRAPE_OK;
}

static void measure(const struct proximity *s, int64_t k, struct wide x[4],
                    struct closest *r)
{
    for (int j = 0; j < 4; j++)
        x[j] = wide_of(s->x[s->pair[4 * k + j]]);
    if (s->kind[k] == CONTACT_VF)
        closest_vf(x, r);
    else
        closest_ee(x, r);
}

/* The sides of a pair: A is the vertex or edge a, B the face or edge b. */
enum side { SIDE_A, SIDE_B, SIDES };

/* The place in the pair of a side's first vertex; for SIDES, of the pair's end.
 */
static int side_start(int kind, int side)
{
    int split = kind == CONTACT_VF ? 1 : 2;
    return side == SIDE_A ? 0 : side == SIDE_B ? split : 4;
}

/* The closest point of a side: in a face, on an edge or at a vertex, by how
 * many vertices have a weight. */
struct foot {
    int vertices;
    int32_t v[2];   /* the first two of them */
    struct wide at; /* m, relative to the first */
    struct wide p;  /* from here to the other side's point, lifted (§2.4) */
};

static struct foot find_foot(const struct proximity *s, int64_t k, int side,
                             const struct wide x[4], const struct closest *r)
{
    const int32_t *v = s->pair + 4 * k;
    int end = side_start(s->kind[k], side + 1);
    struct wide o = x[0], p = side == SIDE_A ? wide_scale(-1, r->p) : r->p;
    struct foot f = {.p = closest_lift(p)};
    for (int j = side_start(s->kind[k], side); j < end; j++) {
        if (r->c[j] == 0)
            continue;
        if (f.vertices == 0)
            o = x[j];
        if (f.vertices < 2)
            f.v[f.vertices] = v[j];
        f.vertices++;
        f.at = wide_axpy(f.at, r->c[j] < 0 ? -r->c[j] : r->c[j],
                         wide_sub(x[j], o));
    }
    return f;
}

/* The led side of a pair: the first whose vertices are all led; SIDES if both
 * have free ones. */
static int led_side(const struct proximity *s, int64_t k)
{
    for (int side = SIDE_A; side < SIDES; side++) {
        int free = 0, end = side_start(s->kind[k], side + 1);
        for (int j = side_start(s->kind[k], side); j < end; j++)
            free += s->w[s->pair[4 * k + j]] > 0;
        if (!free)
            return side;
    }
    return SIDES;
}

/* Whether triangles of the fan of f.v[0] are at the foot. */
static bool is_at(const struct foot *f, const int32_t rim[2])
{
    return f->vertices == 1 || rim[0] == f->v[1] || rim[1] == f->v[1];
}

/* The place of vertex y relative to the foot's first vertex. */
static struct wide beside(const struct proximity *s, const struct foot *f,
                          int32_t y)
{
    return wide_sub(wide_of(s->x[y]), wide_of(s->x[f->v[0]]));
}

/* Whether the foot comes nearer to the other side towards vertex y. */
static bool comes_nearer(const struct proximity *s, const struct foot *f,
                         int32_t y)
{
    struct wide d = closest_lift(wide_sub(beside(s, f, y), f->at));
    double along = wide_dot(f->p, d);
    return along > 0 &&
           along * along > 0x1p-20 * (wide_dot(f->p, f->p) * wide_dot(d, d));
}

/* Whether the foot is the nearest point of the triangles around it. */
static bool is_nearest(const struct proximity *s, const struct foot *f)
{
    int32_t i = f->v[0];
    if (!s->fan.n_start)
        return true;
    for (int32_t k = s->fan.start[i];
         f->vertices < 3 && k < s->fan.start[i + 1]; k++) {
        const int32_t *rim = s->fan.rim[k];
        for (int j = 0; j < 2; j++)
            if (is_at(f, rim) && comes_nearer(s, f, rim[j]))
                return false;
    }
    return true;
}

/* §3.2: the normal of the triangle at the foot that p is most along; false if
 * p is more than 60° off all of them. */
static bool turn_normal(const struct proximity *s, const struct foot *f,
                        struct wide *n)
{
    int32_t i = f->v[0];
    double most = 0.25 * wide_dot(f->p, f->p);
    bool found = false;
    for (int32_t k = s->fan.start[i]; k < s->fan.start[i + 1]; k++) {
        const int32_t *rim = s->fan.rim[k];
        struct wide d = closest_lift(beside(s, f, rim[0]));
        struct wide e = closest_lift(beside(s, f, rim[1]));
        struct wide m = closest_lift(wide_cross(d, e));
        double along = wide_dot(m, f->p), mm = wide_dot(m, m);
        if (!is_at(f, rim) || !(along * along > most * mm))
            continue;
        most = along * along / mm;
        *n = closest_unit(along < 0 ? wide_scale(-1, m) : m, *n);
        found = true;
    }
    return found;
}

/* §3.3: whether the distance of a pair of free sides is the least around: no
 * surface beside its closest points comes nearer. A vertex is itself what is
 * tested against a surface, so its own side is not asked. */
static bool is_least(const struct proximity *s, int64_t k,
                     const struct wide x[4], const struct closest *r)
{
    for (int side = s->kind[k] == CONTACT_VF ? SIDE_B : SIDE_A; side < SIDES;
         side++) {
        struct foot f = find_foot(s, k, side, x, r);
        if (!is_nearest(s, &f))
            return false;
    }
    return true;
}

/* §3.2: the normal at a led side. False if the pair is no contact. */
static bool led_normal(const struct proximity *s, int64_t k, int side,
                       const struct wide x[4], const struct closest *r,
                       struct wide *n)
{
    struct foot f = find_foot(s, k, side, x, r);
    if (is_nearest(s, &f))
        return true;
    if (!turn_normal(s, &f, n))
        return false;
    if (wide_dot(*n, r->p) < 0)
        *n = wide_scale(-1, *n);
    return true;
}

/* §3: the normal: along p, or the primitives' own normal where p is too short
 * to have a direction, or the led surface's where p is none of its normals.
 * False if the pair is no contact. */
static bool find_normal(const struct proximity *s, int64_t k,
                        const struct wide x[4], const struct closest *r,
                        struct wide *n)
{
    struct wide p = closest_unit(r->p, wide_make(1, 0, 0));
    int side = led_side(s, k);
    *n = p;
    if (r->length2 > 0x1p-80 * r->size2)
        return side < SIDES ? led_normal(s, k, side, x, r, n)
                            : is_least(s, k, x, r);
    *n = closest_unit(closest_normal(x, s->kind[k]), p);
    if (wide_dot(*n, r->p) < 0)
        *n = wide_scale(-1, *n);
    return true;
}

static bool is_near(const struct proximity *s, int64_t k)
{
    struct wide x[4], n;
    struct closest r;
    real thickness = skin_pair(&s->skin, s->pair + 4 * k).thickness;
    measure(s, k, x, &r);
    return sqrt(r.length2) < (double)thickness && find_normal(s, k, x, &r, &n);
}

/* §4: the target velocity, which the overlap and the repulsion spring give. */
static real push_target(const struct proximity *s, const struct contact *c,
                        real overlap)
{
    real w = 0;
    for (int k = 0; k < 4; k++)
        w += c->c[k] * c->c[k] * s->w[c->v[k]];
    real spring = s->dt * s->stiffness * overlap * w;
    return real_min(spring, R(0.1) * overlap / s->dt);
}

static void emit(const struct proximity *s, int64_t k, struct contact *c)
{
    struct wide x[4], n;
    struct closest r;
    memcpy(c->v, s->pair + 4 * k, sizeof c->v);
    c->kind = s->kind[k];
    struct surface skin = skin_pair(&s->skin, c->v);
    measure(s, k, x, &r);
    closest_weights(&r, s->kind[k], c->c);
    find_normal(s, k, x, &r, &n);
    c->n = wide_round(n);
    c->gap = (real)wide_dot(n, r.p);
    c->friction = skin.friction;
    c->target = push_target(s, c, real_max(skin.thickness - c->gap, 0));
    c->held = 0;
    c->impulse = c->slide = c->along = 0;
    c->tangent = vec_make(0, 0, 0);
}

int ref_proximity(struct proximity *s)
{
    int status = check(s);
    if (status != DRAPE_OK)
        return status;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->at[k] = is_near(s, k);

    s->found = 0;
    for (int64_t k = 0; k < s->n; k++) {
        bool keep = s->at[k] != 0;
        s->at[k] = keep ? (int32_t)s->found : -1;
        s->found += keep;
    }
    if (s->found > s->cap)
        return DRAPE_EFULL;

    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        if (s->at[k] >= 0)
            emit(s, k, &s->contact[s->at[k]]);
    return DRAPE_OK;
}
