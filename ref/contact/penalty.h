/* SPDX-License-Identifier: Apache-2.0 */
/* Stage penalty: contacts as forces and matrix blocks of the implicit solve.
 * spec/contact/penalty.md */
#ifndef REF_PENALTY_H
#define REF_PENALTY_H

#include "ref/contact/contact.h"

struct penalty {
    int64_t nv, n;  /* vertices, contacts; 4 n < 2^31 */
    const real *w;  /* [nv] 1/kg, ≥ 0; 0: led */
    const vec *u;   /* [nv] m/s, mean velocity of the step */
    const vec *g;   /* [nv] N·s, contacts' impulse so far, of free vertices */
    int first;      /* 1: the first turn of a slice */
    int settled;    /* 1: contacts that are held stay as they are, §1.6 */
    real stiffness; /* N/m, > 0, of the stiffest contact */
    real give;      /* m, > 0, by which a contact is short under its load */
    real dt, tau;   /* s, > 0: the slice, and the integrator's effective step */
    real slip;      /* m/s, > 0: friction is viscous below */
    struct contact *contact; /* [n] out: held, impulse, along, slide, tangent;
                                in: held, along, slide and tangent of the turn
                                before, 0 for a new contact */

    int64_t nv1, n4; /* nv + 1, 4 n */
    int32_t *start;  /* scratch: [nv1] */
    int32_t *item;   /* scratch: [n4] */
    int32_t *vertex; /* scratch: [n4] */
    real *share;     /* scratch: [n] 1/kg, S of §3 */
    real *gave;      /* scratch: [n] N·s, ≥ 0, §1.2 */
    real *rub;       /* scratch: [n4] weights of friction, §2.4 */
    vec *guess;      /* scratch: [nv] m/s, velocity of §1.1 */
    real *parts;     /* scratch: [nv] d, held contacts of a vertex, §2.1 */
    vec *force;      /* out: [nv] N·s, 0 where no contact is held */
    sym *wall;       /* out: [nv] kg, the part of hold of CONTACT_WALL */
    sym *hold;       /* out: [nv] kg, likewise; in, §1.2: of the turn before */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex or setting. */
int ref_penalty(struct penalty *s);

#endif
