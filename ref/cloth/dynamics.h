/* SPDX-License-Identifier: Apache-2.0 */
/* The inputs, scratch and results of one cloth's motion over a step as if
 * nothing were in its way. spec/cloth/dynamics.md */
#ifndef REF_DYNAMICS_H
#define REF_DYNAMICS_H

#include "ref/cloth/cloth.h"

struct packed;
struct trace;

struct dynamics {
    const struct cloth *cloth;
    int method;       /* enum drape_integrator */
    double dt;        /* s, > 0 */
    int newton;       /* implicit: linear systems at most, with kept */
    real tolerance;   /* implicit: of what the motion leaves undone, relative */
    int max_substeps; /* of explicit methods, ≥ 1 */
    vec gravity;      /* m/s² */
    int windy;        /* 0: no air, and no wind stage */
    vec air;          /* m/s */
    real drag, lift;  /* kg/m³, half the air's density × coefficient */
    /* What stage wind writes; not read where there is no air. */
    vec *wind;    /* [count] N */
    vec *gust;    /* scratch: [2·count] N; NULL: a device needs none */
    real *resist; /* scratch: [2·count] kg/s of an implicit method, likewise */
    real *inertia; /* [count] kg, of an implicit method */

    const vec *x, *v;   /* [count] m, m/s, start of the step */
    int has_past;       /* 1: xp and vp hold the step before (second order) */
    const vec *xp, *vp; /* [count] or NULL */
    const vec *to;      /* [count] m, where pinned particles end */
    const vec *u;       /* [count] m/s, mean velocity of the step so far, where
                           contacts take part in it (lagrange.md) */
    bool met;           /* contacts took part: they may add energy */

    /* Solves (dynamics_mass + Σ blocks) dv = b with dv = 0 where fixed; reads
     * cloth, block and b, writes dv, iterations and residual, and ors
     * DRAPE_UNCONVERGED into outcome. DRAPE_OK or negative. NULL for
     * explicit methods. */
    int (*solve)(struct dynamics *s);
    void *solver; /* solve's own; a device's: the struct sheet */

    vec *work;  /* scratch: [dynamics_vecs()·count] */
    vec *kept;  /* scratch: [2·count] of Newton's method; NULL: one system is
                   solved, and nothing is computed after it */
    sym *block; /* scratch: [SPRINGS·count] of an implicit method, or NULL */
    struct packed
        *packed; /* scratch: likewise, of one with multigrid, or NULL */
    real *chunk; /* scratch: [3·sum_chunks(count)] */

    struct trace *trace; /* NULL: none */

    /* Set by the backend, in its memory. Streams: [count], within work. */
    const struct law *law;     /* [SPRINGS] the cloth's */
    const struct piece *piece; /* [PIECES] likewise */
    const real *triple;        /* [TRIPLES] likewise */
    vec *force;                /* N */
    vec *star, *back, *q; /* m/s, implicit.md §1; back, q: second order only */
    vec *b, *dv;          /* N·s, m/s: set for solve */
    real asked;           /* set for solve: relative residual, 0: its own */

    double reference, surplus; /* in, out: J, §3; 0 at first */
    vec *x1, *v1;              /* out: [count], not x or v */
    int32_t substeps;          /* out: made, or needed (DRAPE_ELIMIT) */
    int solves;                /* out: linear systems */
    int iterations;            /* out: of the solver, all systems */
    double residual;           /* out: relative, of the solver; with kept: what
                                  the motion leaves undone */
    const vec *at;             /* out: [count] m, where `block` was made */
    int outcome;               /* out: or of enum drape_outcome */
    double before[3];          /* out: kinetic, elastic, of gravity, J, at x */
    double energy[3];          /* out: likewise at x1 */
};

static inline bool dynamics_implicit(int method)
{
    return method >= DRAPE_BW;
}

/* Whether the method is the second-order backward difference. */
static inline bool dynamics_second(int method)
{
    return method == DRAPE_CK || method == DRAPE_BDF2;
}

/* Streams of vec in work. */
static inline int64_t dynamics_vecs(int method)
{
    return method == DRAPE_BW ? 4 : dynamics_second(method) ? 6 : 5;
}

/* The diagonal part of the linear system, [count] kg: the mass, and what air
 * adds to it (wind.md §3). */
static inline const real *dynamics_mass(const struct dynamics *s)
{
    return s->windy ? s->inertia : s->cloth->mass;
}

#endif
