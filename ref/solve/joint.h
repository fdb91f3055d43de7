/* SPDX-License-Identifier: Apache-2.0 */
/* The system of all cloths and their contacts, which one solve takes together.
 * spec/contact/lagrange.md §3.2 */
#ifndef REF_JOINT_H
#define REF_JOINT_H

#include "ref/contact/coulomb.h"

struct world;

/* Of the last step, by Jacobi (lagrange.md §3.2). */
#define JOINT_LAST_PART (R(2.0) / 3)

struct joint {
    int64_t nc;     /* particles of all cloths */
    real tolerance; /* ≥ 0, in the energy norm, of the first residual */
    int32_t max_iterations; /* ≥ 0 */
    const sym *bound,
        *single;        /* [nv] kg, of coulomb; bound as M was made with */
    const vec *b;       /* [nc] N·s, 0 where fixed */
    int32_t epoch;      /* another one where other cloths are asleep */
    struct links links; /* the contacts; x and y are set by the solve */

    vec *r, *p, *p2;  /* scratch: [nv], 0 where fixed; p2: the device's */
    real *item;       /* scratch: [nc], the device's */
    int64_t n_chunks; /* sum_chunks(nc) */
    real *chunk;      /* scratch: [3·n_chunks] */

    vec *dv;            /* out: [nv] m/s, 0 where fixed */
    vec *q;             /* out: [nv] N·s, A dv without contacts; undefined if
                           iterations is 0 */
    int32_t iterations; /* out: products with a search direction */
    int32_t outcome;    /* out: enum pcg_outcome */
};

#endif
