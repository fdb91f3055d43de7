/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts and their surfaces on the device, as in ref/contact/contact.h. */
#ifndef GPU_CONTACT_CUH
#define GPU_CONTACT_CUH

#include "gpu/broad/pair.cuh"

extern "C" {
#include "ref/contact/contact.h"
}

static __device__ inline bool any_free(const int32_t v[4], const real *w)
{
    bool free = false;
    for (int j = 0; j < 4; j++)
        free |= w[v[j]] > 0;
    return free;
}

/* The largest thickness and the largest friction of the four vertices. */
static __device__ inline struct surface surface_of(const struct surfaces *s,
                                                   const int32_t v[4])
{
    struct surface r = s->surface[s->of[v[0]]];
    for (int j = 1; j < 4; j++) {
        struct surface t = s->surface[s->of[v[j]]];
        r.thickness = max_of(r.thickness, t.thickness);
        r.friction = max_of(r.friction, t.friction);
    }
    return r;
}

/* The weighted sum Σ c a in this order: ((c0 a0 + c1 a1) + c2 a2) + c3 a3. */
static __device__ inline vec pair_sum(const struct contact *c, const vec *a)
{
    vec r = scale(c->c[0], a[c->v[0]]);
    for (int j = 1; j < 4; j++)
        r = axpy(r, c->c[j], a[c->v[j]]);
    return r;
}

/* A new contact's impulses, multipliers and matrix: none. */
static __device__ inline void clear_contact(struct contact *c)
{
    c->coupling = CONTACT_APART;
    c->impulse = c->lambda = c->load = c->kappa = c->rise = 0;
    c->stiffness_n = c->stiffness_t = 0;
    c->tangent = c->lambda_t = c->way = make(0, 0, 0);
}

#endif
