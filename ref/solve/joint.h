/* SPDX-License-Identifier: Apache-2.0 */
/* The system of all cloths and their contacts, which one solve takes together.
 * spec/contact/penalty.md §4 */
#ifndef REF_JOINT_H
#define REF_JOINT_H

#include "ref/contact/penalty.h"

struct world;

struct joint {
    int64_t nc;             /* particles of all cloths */
    real tolerance;         /* ≥ 0, in the energy norm (pcg.md §4.1) */
    real exact;             /* ≥ 0, in the norm of the residual, likewise */
    int32_t max_iterations; /* ≥ 0 */
    real scale, square;     /* inout: pcg.md §4.1, of the step so far */
    const sym *hold, *wall; /* [nv] kg, of penalty */
    const vec *b;           /* [nc] N·s, 0 where fixed */
    const vec *last;    /* [nc] m/s, 0 where fixed: a first direction, the dv of
                           such a solve before; NULL: none */
    int32_t epoch;      /* another one where other cloths are asleep */
    bool weigh;         /* scale is found before that direction is taken */
    struct links links; /* the contacts; x and y are set by the solve */

    vec *r, *p, *p2;  /* scratch: [nv], 0 where fixed; p2: the device's */
    real *item;       /* scratch: [nc], the device's */
    int64_t n_chunks; /* sum_chunks(nc) */
    real *chunk;      /* scratch: [3·n_chunks] */

    vec *dv;            /* out: [nv] m/s, 0 where fixed */
    vec *q;             /* out: [nv] N·s, A dv; undefined if iterations is 0 */
    int32_t iterations; /* out: products with a search direction */
    int32_t outcome;    /* out: enum pcg_outcome */
    real residual;      /* out: |b - (A + C) dv| / √square */
};

/* Runs the solve by the reference. DRAPE_OK however it ends, or the status of a
 * stage. */
int joint_solve(struct world *w, struct joint *a);

#endif
