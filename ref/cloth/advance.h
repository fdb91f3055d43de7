/* SPDX-License-Identifier: Apache-2.0 */
/* Stage advance: the update of positions and velocities that every explicit
 * method is composed of. spec/cloth/advance.md */
#ifndef REF_ADVANCE_H
#define REF_ADVANCE_H

#include "ref/cloth/cloth.h"

/* §3: radius of a half disk in which RK4 is stable. */
#define RK4_RADIUS 2.6

struct advance {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    const real *mass;     /* [count] kg, > 0 where fixed is 0 */
    const vec *x, *v;     /* [count] m, m/s */
    const vec *rate;      /* [count] m/s, velocity that moves x, if not
                             symplectic */
    const vec *force;     /* [count] N */
    int symplectic;       /* 1: the new velocity moves x */
    real a, b;            /* s, by which x and v advance */
    const vec *from, *to; /* [count] m, pins at the start and end of the step */
    real at;              /* 0 … 1, time of the result within the step */
    real dt;              /* s, the step, > 0 */
    vec *x1, *v1;         /* out: [count]; may be x and v */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_advance(struct advance *s);

/* §3: whether an explicit method is stable with `substeps` equal substeps of
 * dt; bound (of the eigenvalues of M⁻¹K) and beta are of struct cloth. */
bool advance_stable(int method, double dt, int64_t substeps, double bound,
                    double beta);
/* The smallest stable number of substeps; INT32_MAX if no smaller number is
 * stable. */
int32_t advance_substeps(int method, double dt, double bound, double beta);
/* §4: the same for all modes of a cloth, whose limits stiffen it but do not
 * damp it. */
int32_t advance_substeps_of(int method, double dt, const struct cloth *c);
#endif
