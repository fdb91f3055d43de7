/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of the reference over the points of seams; the device has the same
 * in gpu/seam/seam.cu. spec/seam/seam.md */
#include "ref/contact/carry.h"
#include "ref/contact/lagrange.h"

/* §1: the gap of a point, by differences, so that its rounding does not grow
 * with the distance from the origin. */
static vec gap_of(const struct seam_point *p, const vec *x)
{
    vec a = vec_sub(x[p->v[0]], x[p->v[1]]);
    vec b = vec_sub(x[p->v[0]], x[p->v[2]]);
    return vec_axpy(vec_scale(p->c[0], a), p->c[1], b);
}

void ref_seam_gap(struct gpu *on, int64_t n, const struct seam_point *point,
                  const vec *x, vec *gap)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < n; k++)
        gap[k] = gap_of(&point[k], x);
}

/* How much velocity a contact gains by an impulse along it, 1/kg. */
static real mobility_of(const struct seam *s, const struct contact *c)
{
    real y = 0;
    for (int j = 0; j < 4; j++)
        y += c->c[j] * c->c[j] * s->w[c->v[j]];
    return y;
}

/* §3 */
static real kappa_of(const struct seam *s, const struct contact *c,
                     real stiffness)
{
    real y = mobility_of(s, c);
    return y > 0 ? real_max(stiffness * s->tau * s->tau, CARRY_KAPPA / y) : 0;
}

/* §6.2: the contact of hinge k. */
static struct contact contact_of(const struct seam *s, int64_t k)
{
    const struct seam_hinge *h = &s->hinge[k];
    struct contact c = {.kind = CONTACT_EE};
    memcpy(c.v, h->v, sizeof c.v);
    memcpy(c.c, h->c, sizeof c.c);
    contact_clear(&c);
    vec at = s->x0[h->v[1]];
    vec z = vec_scale(h->c[0], vec_sub(s->x0[h->v[0]], at));
    z = vec_axpy(z, h->c[2], vec_sub(s->x0[h->v[2]], at));
    z = vec_axpy(z, h->c[3], vec_sub(s->x0[h->v[3]], at));
    c.n = vec_make(-z.x / s->dt, -z.y / s->dt, -z.z / s->dt);
    const struct seam_point *p = &s->point[h->point];
    real open = vec_length(gap_of(p, s->x0)) / h->behind;
    real stiffness = h->stiffness * real_max(1 - open, 0);
    if (p->strength > 0) {
        real spare = p->strength - vec_length(s->pull[h->point]);
        stiffness = spare > 0 ? stiffness : 0;
        c.load = s->tau * (real_max(spare, 0) / (c.c[2] + c.c[3]));
    }
    c.kappa = mobility_of(s, &c) > 0 ? stiffness * s->tau * s->tau : 0;
    return c;
}

/* sewn.md §2: b (I - z zᵀ). */
static sym matrix_of(real b, vec z)
{
    return (sym){b - b * z.x * z.x, -(b * z.x * z.y), -(b * z.x * z.z),
                 b - b * z.y * z.y, -(b * z.y * z.z), b - b * z.z * z.z};
}

void ref_seam_matrix(struct gpu *on, int64_t n, const struct contact *seams,
                     sym *kappa)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < n; k++) {
        bool holds = seams && seams[k].coupling == CONTACT_MUTUAL;
        kappa[k] = holds ? matrix_of(seams[k].stiffness_t, seams[k].way)
                         : matrix_of(0, vec_make(0, 0, 0));
    }
}

void ref_seam_open(struct gpu *on, const struct seam *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        const struct seam_point *p = &s->point[k];
        struct contact c = {.kind = CONTACT_VF,
                            .v = {p->v[0], p->v[1], p->v[2], p->v[2]},
                            .c = {1, -p->c[0], p->c[1] > 0 ? -p->c[1] : 0, 0}};
        contact_clear(&c);
        vec way = vec_sub(s->target[k], gap_of(p, s->x0));
        c.n = vec_make(way.x / s->dt, way.y / s->dt, way.z / s->dt);
        c.lambda_t = vec_scale(s->tau, s->pull[k]);
        c.kappa = kappa_of(s, &c, p->stiffness);
        c.load = s->tau * p->strength;
        s->contact[k] = c;
    }
    EACH_ITEM
    for (int64_t k = 0; k < s->n_hinges; k++)
        s->contact[s->n + k] = contact_of(s, k);
}

void ref_seam_close(struct gpu *on, const struct seam *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        vec p = s->contact[k].tangent;
        s->next[k] = s->contact[k].kappa > 0
                         ? vec_make(p.x / s->tau, p.y / s->tau, p.z / s->tau)
                         : s->pull[k];
    }
}
