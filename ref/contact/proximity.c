/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the candidates closer than their thickness and makes them contacts.
 * spec/contact/proximity.md */
#include "ref/contact/proximity.h"

#include "ref/narrow/closest.h"

static int check_input(const struct proximity *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->stiffness >= 0) ||
        !(s->range > 0 && s->range <= REAL_BIG) ||
        (s->n_from && s->n_from != s->nv))
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv) || s->kind[k] > CONTACT_EE)
            return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        for (int j = 0; j < 4; j++) {
            int32_t v = s->pair[4 * k + j];
            if (!vec_sane(s->x[v]) || (s->n_from && !vec_sane(s->from[v])))
                return DRAPE_EDATA;
        }
    return DRAPE_OK;
}

static void measure_pair(const struct proximity *s, int64_t k, struct wide x[4],
                         struct closest *r)
{
    for (int j = 0; j < 4; j++)
        x[j] = wide_of(s->x[s->pair[4 * k + j]]);
    if (s->kind[k] == CONTACT_VF)
        closest_vf(x, r);
    else
        closest_ee(x, r);
}

/* The closest point of pair k on a side. */
static struct closest_point find_closest_point(const struct proximity *s,
                                               int64_t k, int side,
                                               const struct wide x[4],
                                               const struct closest *r)
{
    int kind = s->kind[k];
    struct wide p = side == SIDE_A ? wide_scale(-1, r->p) : r->p;
    return closest_point_find(s->pair + 4 * k, side_start(kind, side),
                              side_start(kind, side + 1), x, r->c, p);
}

/* §3.3: whether the distance of a pair of free sides is the least around: no
 * surface beside its closest points comes nearer. A vertex is itself what is
 * tested against a surface, so its own side is not asked. */
static bool is_least(const struct proximity *s, int64_t k,
                     const struct wide x[4], const struct closest *r)
{
    struct places places = {.x0 = s->x};
    for (int side = s->kind[k] == CONTACT_VF ? SIDE_B : SIDE_A; side < SIDES;
         side++) {
        struct closest_point f = find_closest_point(s, k, side, x, r);
        if (!closest_point_is_local(&places, &s->one_rings, &f, CLOSEST_FREE))
            return false;
    }
    return true;
}

/* §3.2: the normal at a prescribed side. False if the pair is no contact. */
static bool prescribed_normal(const struct proximity *s, int64_t k, int side,
                              const struct wide x[4], const struct closest *r,
                              struct wide *n)
{
    struct places places = {.x0 = s->x};
    struct closest_point f = find_closest_point(s, k, side, x, r);
    if (closest_point_is_local(&places, &s->one_rings, &f, CLOSEST_PRESCRIBED))
        return true;
    if (!closest_point_normal(&places, &s->one_rings, &f, 0.25, n))
        return false;
    if (wide_dot(*n, r->p) < 0)
        *n = wide_scale(-1, *n);
    return true;
}

/* §3: the normal: along p, or the primitives' own normal where p is too short
 * to have a direction, or the prescribed surface's where p is none of its
 * normals. False if the pair is no contact. */
static bool find_normal(const struct proximity *s, int64_t k,
                        const struct wide x[4], const struct closest *r,
                        struct wide *n)
{
    struct wide p = closest_unit(r->p, wide_make(1, 0, 0));
    int side = prescribed_side(s->kind[k], s->pair + 4 * k, s->w);
    *n = p;
    if (r->length2 > 0x1p-80 * r->size2)
        return side < SIDES ? prescribed_normal(s, k, side, x, r, n)
                            : is_least(s, k, x, r);
    *n = closest_unit(closest_normal(x, s->kind[k]), p);
    if (wide_dot(*n, r->p) < 0)
        *n = wide_scale(-1, *n);
    return true;
}

/* §3.4: whether pair k stands for its closest points. Where these are on an
 * edge or at a vertex they are those of other pairs, too. */
static bool stands_for_points(const struct proximity *s, int64_t k,
                              const struct wide x[4], const struct closest *r)
{
    const int32_t *v = s->pair + 4 * k;
    if (s->kind[k] == CONTACT_EE)
        return r->c[0] != 0 && r->c[1] != 0 && r->c[2] != 0 && r->c[3] != 0;
    struct closest_point f = find_closest_point(s, k, SIDE_B, x, r);
    return closest_point_is_first(&s->one_rings, &f, v + 1, v[0]);
}

/* §3, §3.5: Σ c x at the start of the slice. */
static struct wide start_vector(const struct proximity *s, int64_t k,
                                const struct closest *r)
{
    const int32_t *v = s->pair + 4 * k;
    if (!s->n_from)
        return r->p;
    struct wide first = wide_of(s->from[v[0]]), p = wide_make(0, 0, 0);
    for (int j = 0; j < 4; j++)
        p = wide_axpy(p, r->c[j], wide_sub(wide_of(s->from[v[j]]), first));
    return p;
}

static real thickness_of(const struct proximity *s, int64_t k)
{
    return surfaces_pair(&s->surfaces, s->pair + 4 * k).thickness;
}

/* §3.5: whether the pair comes nearer, from beyond the range and from the side
 * on which it ends. */
static bool arrives(const struct proximity *s, int64_t k, struct wide n,
                    const struct closest *r)
{
    if (!s->n_from)
        return true;
    struct wide p = start_vector(s, k, r);
    double gap = wide_dot(n, p);
    real least = s->range * thickness_of(s, k);
    return gap >= 0 && gap > wide_dot(n, r->p) &&
           sqrt(wide_dot(p, p)) >= (double)least;
}

/* The distance within which the pair is a contact. */
static real reach_of(const struct proximity *s, int64_t k)
{
    return (s->n_from ? 1 : s->range) * thickness_of(s, k);
}

static bool is_close(const struct proximity *s, int64_t k)
{
    struct wide x[4], n;
    struct closest r;
    measure_pair(s, k, x, &r);
    return sqrt(r.length2) < (double)reach_of(s, k) &&
           stands_for_points(s, k, x, &r) && find_normal(s, k, x, &r, &n) &&
           arrives(s, k, n, &r);
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

static void emit_contact(const struct proximity *s, int64_t k,
                         struct contact *c)
{
    struct wide x[4], n;
    struct closest r;
    memcpy(c->v, s->pair + 4 * k, sizeof c->v);
    c->kind = s->kind[k];
    struct surface surface = surfaces_pair(&s->surfaces, c->v);
    measure_pair(s, k, x, &r);
    closest_weights(&r, s->kind[k], c->c);
    find_normal(s, k, x, &r, &n);
    c->n = wide_round(n);
    c->gap = (real)wide_dot(n, start_vector(s, k, &r));
    c->friction = surface.friction;
    c->target = push_target(s, c, real_max(surface.thickness - c->gap, 0));
    contact_clear(c);
}

int ref_proximity(struct proximity *s)
{
    int status = check_input(s);
    if (status != DRAPE_OK)
        return status;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->at[k] = is_close(s, k);

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
            emit_contact(s, k, &s->contact[s->at[k]]);
    return DRAPE_OK;
}
