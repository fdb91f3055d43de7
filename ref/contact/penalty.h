/* SPDX-License-Identifier: Apache-2.0 */
/* Stage penalty: contacts as the implicit system feels them.
 * spec/contact/penalty.md */
#ifndef REF_PENALTY_H
#define REF_PENALTY_H

#include "ref/contact/contact.h"

struct penalty {
    int64_t nv, n;  /* vertices, contacts; 4 n < 2^31 */
    const real *w;  /* [nv] 1/kg, ≥ 0; 0: led */
    const vec *u;   /* [nv] m/s, mean velocity of the step */
    const vec *g;   /* [nv] N·s, what they took up so far, where free */
    int first;      /* 1: the first turn of a slice, which none is before */
    real stiffness; /* N/m, > 0, of a contact */
    real dt, tau;   /* s, > 0: step, and the solver's span */
    real slip;      /* m/s, > 0: friction is viscous below */
    struct contact *contact; /* [n], out: held, impulse, slide and tangent; in
                                later turns in: held, 0 where new */

    int64_t nv1, n4; /* nv + 1, 4 n */
    int32_t *start;  /* scratch: [nv1] */
    int32_t *item;   /* scratch: [n4] */
    int32_t *vertex; /* scratch: [n4] */
    real *share;     /* scratch: [n] */
    real *most;      /* scratch: [n] N·s */
    real *gave;      /* scratch: [n] N·s, ≥ 0 */
    real *more;      /* scratch: [n] N·s */
    vec *guess;      /* scratch: [nv] m/s */
    real *brake;     /* scratch: [nv] parts of a vertex, then m/s */
    vec *force;      /* out: [nv] N·s, 0 where no contact pushes */
    sym *hold;       /* out: [nv] kg, 0 likewise; in later turns in: §1 */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex or setting. */
int ref_penalty(struct penalty *s);

#endif
