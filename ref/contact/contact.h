/* SPDX-License-Identifier: Apache-2.0 */
/* The contact: a constraint on the velocities of four vertices. Proximity and
 * impulses make contacts; coulomb and contacts find their impulses.
 * spec/contact/contacts.md */
#ifndef REF_CONTACT_H
#define REF_CONTACT_H

#include "ref/broad/pair.h"

/* Whether a contact takes part in the implicit solve: not; as one that moves
 * several vertices; as one that moves one vertex alone. */
enum contact_coupling { CONTACT_APART, CONTACT_MUTUAL, CONTACT_SINGLE };

/* A contact holds two sides, A and B, apart: it asks for n·Σ c u ≥ target. */
struct contact {
    int32_t v[4];     /* vertices, as the pair names them */
    int32_t kind;     /* enum contact_kind */
    int32_t coupling; /* enum contact_coupling; coulomb.md §3 */
    real c[4];        /* weights: side A adds to 1, side B to -1 */
    vec n;            /* unit, from B to A */
    real gap;         /* m, n·Σ c x at the start of the step */
    real target;      /* m/s, lower bound of n·Σ c u */
    real friction;    /* Coulomb coefficient */
    real impulse;     /* N·s along n; ≥ 0 after stage contacts */
    vec tangent;      /* N·s across n, |tangent| ≤ friction · impulse */
    real lambda;      /* N·s, ≥ 0: multiplier along n; coulomb.md §1 */
    vec lambda_t;     /* N·s, ⊥ n: multiplier across n; coulomb.md §2 */
    real load;  /* N·s, ≥ 0: N, which limits friction; coulomb.md §2 */
    real kappa; /* kg, ≥ 0: κ; 0: carry.md has not set the contact up */
    real rise;  /* N·s, by which lambda rose when it was last renewed */
    real stiffness_n; /* kg, of its matrix along n; coulomb.md §3 */
    real stiffness_t; /* kg, likewise across n */
    vec way;          /* unit, along the friction of a contact that slides, else
                         0: no matrix this way */
};

/* Contact properties of a body's surface. A pair has the largest value of each
 * property among its four vertices. */
struct surface {
    real thickness; /* m, ≥ 0: distance at which contact begins */
    real friction;  /* ≥ 0 */
};

/* A new contact's impulses, multipliers and matrix: none. */
static inline void contact_clear(struct contact *c)
{
    vec none = vec_make(0, 0, 0);
    c->coupling = CONTACT_APART;
    c->impulse = c->lambda = c->load = c->kappa = c->rise = 0;
    c->stiffness_n = c->stiffness_t = 0;
    c->tangent = c->lambda_t = c->way = none;
}

/* The surface of each vertex. */
struct surfaces {
    int64_t n;                     /* surfaces, ≥ 1 */
    const uint16_t *of;            /* [nv] index of the surface, 0 … n - 1 */
    const struct surface *surface; /* [n] */
};

static inline struct surface surfaces_pair(const struct surfaces *s,
                                           const int32_t v[4])
{
    struct surface r = s->surface[s->of[v[0]]];
    for (int k = 1; k < 4; k++) {
        struct surface t = s->surface[s->of[v[k]]];
        r.thickness = real_max(r.thickness, t.thickness);
        r.friction = real_max(r.friction, t.friction);
    }
    return r;
}

/* The sides of a pair: A is the vertex, or edge a; B the face, or edge b. */
enum side { SIDE_A, SIDE_B, SIDES };

/* The place in a pair of a side's first vertex; for SIDES, of the pair's end.
 */
static inline int side_start(int kind, int side)
{
    int split = kind == CONTACT_VF ? 1 : 2;
    return side == SIDE_A ? 0 : side == SIDE_B ? split : 4;
}

/* The prescribed side of a pair: the first whose vertices are all prescribed;
 * SIDES if both have free ones. */
static inline int prescribed_side(int kind, const int32_t v[4], const real *w)
{
    for (int side = SIDE_A; side < SIDES; side++) {
        int free = 0, end = side_start(kind, side + 1);
        for (int j = side_start(kind, side); j < end; j++)
            free += w[v[j]] > 0;
        if (!free)
            return side;
    }
    return SIDES;
}

/* The weighted sum Σ c a in this order: ((c0 a0 + c1 a1) + c2 a2) + c3 a3. */
static inline vec pair_sum(const int32_t v[4], const real c[4], const vec *a)
{
    vec r = vec_scale(c[0], a[v[0]]);
    for (int k = 1; k < 4; k++)
        r = vec_axpy(r, c[k], a[v[k]]);
    return r;
}

#endif
