/* SPDX-License-Identifier: Apache-2.0 */
/* What proximity and impulses emit and contacts solves:
 * spec/contact/contacts.md */
#ifndef REF_CONTACT_H
#define REF_CONTACT_H

#include "ref/base/stage.h"

enum contact_kind { CONTACT_VF, CONTACT_EE };

/* Two sides, A and B, that must not come closer. */
struct contact {
    int32_t v[4];  /* vertices, as the pair names them */
    int32_t kind;  /* enum contact_kind */
    int32_t held;  /* 1: the implicit solve feels it; penalty.md §1 */
    real c[4];     /* weights: side A adds to 1, side B to -1 */
    vec n;         /* unit, from B to A */
    real gap;      /* m, n·Σ c x at the start of the step */
    real target;   /* m/s, n·Σ c u ≥ target is asked for */
    real friction; /* Coulomb coefficient */
    real impulse;  /* N·s along n, ≥ 0: what contacts found */
    vec tangent;   /* N·s across n, |tangent| ≤ friction · impulse */
    real slide;    /* kg, of friction in the solve; penalty.md §2 */
};

/* What a body's surface is like; a pair takes the larger of each. */
struct surface {
    real thickness; /* m, ≥ 0: distance at which contact begins */
    real friction;  /* ≥ 0 */
};

/* Which surface each vertex has. */
struct skin {
    int64_t n;                     /* surfaces, ≥ 1 */
    const uint16_t *of;            /* [nv] in 0 … n - 1 */
    const struct surface *surface; /* [n] */
};

static inline struct surface skin_pair(const struct skin *s, const int32_t v[4])
{
    struct surface r = s->surface[s->of[v[0]]];
    for (int k = 1; k < 4; k++) {
        struct surface t = s->surface[s->of[v[k]]];
        r.thickness = real_max(r.thickness, t.thickness);
        r.friction = real_max(r.friction, t.friction);
    }
    return r;
}

/* Whether all four name one of nv vertices. */
static inline bool pair_valid(const int32_t v[4], int64_t nv)
{
    for (int k = 0; k < 4; k++)
        if (v[k] < 0 || v[k] >= nv)
            return false;
    return true;
}

/* ((c0 a0 + c1 a1) + c2 a2) + c3 a3. */
static inline vec pair_sum(const int32_t v[4], const real c[4], const vec *a)
{
    vec r = vec_scale(c[0], a[v[0]]);
    for (int k = 1; k < 4; k++)
        r = vec_axpy(r, c[k], a[v[k]]);
    return r;
}

#endif
