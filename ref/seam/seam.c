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

/* §3 */
static real kappa_of(const struct seam *s, const struct contact *c,
                     real stiffness)
{
    real y = 0;
    for (int j = 0; j < 3; j++)
        y += c->c[j] * c->c[j] * s->w[c->v[j]];
    return y > 0 ? real_max(stiffness * s->tau * s->tau, CARRY_KAPPA / y) : 0;
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
