/* SPDX-License-Identifier: Apache-2.0 */
/* Stage advance: the update that every explicit method is made of.
 * spec/cloth/advance.md */
#ifndef REF_ADVANCE_H
#define REF_ADVANCE_H

#include "ref/cloth/cloth.h"

/* §3: radius of a half disk of stability of RK4. */
#define RK4_RADIUS 2.6

struct advance {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    const real *mass;     /* [count] kg, > 0 where fixed is 0 */
    const vec *x, *v;     /* [count] m, m/s */
    const vec *rate;      /* [count] m/s, velocity that moves x */
    const vec *force;     /* [count] N, that changes v */
    int symplectic;       /* 1: the new velocity moves x instead */
    real a, b;            /* s, spans of x and of v */
    const vec *from, *to; /* [count] m, pins at the step's ends */
    real at;              /* 0 … 1, where in the step the result is */
    real dt;              /* s, the step, > 0 */
    vec *x1, *v1;         /* out: [count]; may be x and v */
};

/* DRAPE_OK. What is not finite stays so. */
int ref_advance(struct advance *s);

/* §3: whether `substeps` equal parts of dt are stable, by the bound on the
 * eigenvalues of M⁻¹K and beta of struct cloth. For explicit methods. */
bool advance_stable(int method, double dt, int64_t substeps, double bound,
                    double beta);
/* The least such number; INT32_MAX if that is not enough. */
int32_t advance_substeps(int method, double dt, double bound, double beta);
#endif
