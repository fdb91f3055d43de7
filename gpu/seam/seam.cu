/* SPDX-License-Identifier: Apache-2.0 */
/* The points of seams on the device: ref/seam/seam.c. spec/seam/seam.md */
#include "gpu/contact/contact.cuh"

extern "C" {
#include "gpu/run/backend.h"
#include "ref/contact/carry.h"
#include "ref/contact/lagrange.h"
}

/* §1: the gap of a point. */
static __device__ vec gap_of(const struct seam_point *p, const vec *x)
{
    vec a = sub(x[p->v[0]], x[p->v[1]]), b = sub(x[p->v[0]], x[p->v[2]]);
    return axpy(scale(p->c[0], a), p->c[1], b);
}

/* Thread k owns point k. */
KERNEL seam_gap_kernel(int64_t n, const struct seam_point *point, const vec *x,
                       vec *gap)
{
    ITEM(k, n);
    gap[k] = gap_of(&point[k], x);
}

void gpu_seam_gap(struct gpu *g, int64_t n, const struct seam_point *point,
                  const vec *x, vec *gap)
{
    LAUNCH(g, n, seam_gap_kernel, n, point, x, gap);
}

/* sewn.md §2: b (I - z zᵀ). */
static __device__ sym matrix_of(real b, vec z)
{
    return sym{b - b * z.x * z.x, -(b * z.x * z.y), -(b * z.x * z.z),
               b - b * z.y * z.y, -(b * z.y * z.z), b - b * z.z * z.z};
}

/* Thread k owns kappa[k]. */
KERNEL seam_matrix_kernel(int64_t n, const struct contact *seams, sym *kappa)
{
    ITEM(k, n);
    bool holds = seams && seams[k].coupling == CONTACT_MUTUAL;
    kappa[k] = holds ? matrix_of(seams[k].stiffness_t, seams[k].way)
                     : matrix_of(0, make(0, 0, 0));
}

void gpu_seam_matrix(struct gpu *g, int64_t n, const struct contact *seams,
                     sym *kappa)
{
    LAUNCH(g, n, seam_matrix_kernel, n, seams, kappa);
}

/* How much velocity a contact gains by an impulse along it, 1/kg. */
static __device__ real mobility_of(const struct seam *s,
                                   const struct contact *c)
{
    real y = 0;
    for (int j = 0; j < 4; j++)
        y += c->c[j] * c->c[j] * s->w[c->v[j]];
    return y;
}

/* §3 */
static __device__ real kappa_of(const struct seam *s, const struct contact *c,
                                real stiffness)
{
    real y = mobility_of(s, c);
    return y > 0 ? max_of(stiffness * s->tau * s->tau, CARRY_KAPPA / y)
                 : R(0.0);
}

/* Thread k owns point k: writes its contact. */
KERNEL seam_open_kernel(const struct seam &s)
{
    ITEM(k, s.n);
    const struct seam_point *p = &s.point[k];
    struct contact c = {};
    c.kind = CONTACT_VF;
    for (int j = 0; j < 4; j++)
        c.v[j] = p->v[j < 3 ? j : 2];
    c.c[0] = 1;
    c.c[1] = -p->c[0];
    c.c[2] = p->c[1] > 0 ? -p->c[1] : R(0.0);
    clear_contact(&c);
    vec way = sub(s.target[k], gap_of(p, s.x0));
    c.n = make(way.x / s.dt, way.y / s.dt, way.z / s.dt);
    c.lambda_t = scale(s.tau, s.pull[k]);
    c.kappa = kappa_of(&s, &c, p->stiffness);
    c.load = s.tau * p->strength;
    s.contact[k] = c;
}

/* §6.2. Thread k owns hinge k: writes its contact. */
KERNEL seam_hinge_kernel(const struct seam &s)
{
    ITEM(k, s.n_hinges);
    const struct seam_hinge *h = &s.hinge[k];
    struct contact c = {};
    c.kind = CONTACT_EE;
    for (int j = 0; j < 4; j++) {
        c.v[j] = h->v[j];
        c.c[j] = h->c[j];
    }
    clear_contact(&c);
    vec at = s.x0[h->v[1]];
    vec z = scale(h->c[0], sub(s.x0[h->v[0]], at));
    z = axpy(z, h->c[2], sub(s.x0[h->v[2]], at));
    z = axpy(z, h->c[3], sub(s.x0[h->v[3]], at));
    c.n = make(-z.x / s.dt, -z.y / s.dt, -z.z / s.dt);
    const struct seam_point *p = &s.point[h->point];
    real open = length(gap_of(p, s.x0)) / h->behind;
    real stiffness = h->stiffness * max_of(1 - open, R(0.0));
    if (p->strength > 0) {
        real spare = p->strength - length(s.pull[h->point]);
        stiffness = spare > 0 ? stiffness : R(0.0);
        c.load = s.tau * (max_of(spare, R(0.0)) / (c.c[2] + c.c[3]));
    }
    c.kappa = mobility_of(&s, &c) > 0 ? stiffness * s.tau * s.tau : R(0.0);
    s.contact[s.n + k] = c;
}

void gpu_seam_open(struct gpu *g, const struct seam *s)
{
    LAUNCH(g, s->n, seam_open_kernel, *s);
    if (s->n_hinges > 0)
        LAUNCH(g, s->n_hinges, seam_hinge_kernel, *s);
}

/* Thread k owns point k: writes next[k]. */
KERNEL seam_close_kernel(const struct seam &s)
{
    ITEM(k, s.n);
    const struct contact *c = &s.contact[k];
    vec p = c->tangent;
    s.next[k] =
        c->kappa > 0 ? make(p.x / s.tau, p.y / s.tau, p.z / s.tau) : s.pull[k];
}

void gpu_seam_close(struct gpu *g, const struct seam *s)
{
    LAUNCH(g, s->n, seam_close_kernel, *s);
}
