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
    int first;      /* 1: these contacts have had no turn yet */
    int follows;    /* 1: contacts go on, and their friction follows the loads
                       that a solve found, §2.5 */
    int joins;      /* 1, if follows: those that are not held are looked at */
    int64_t n_dv;   /* nv, or 0: no solve came after the call before */
    const vec *dv;  /* [n_dv] m/s, what that solve found */
    real stiffness; /* N/m, > 0, of the stiffest contact */
    real give;      /* m, > 0, by which a contact is short under its load */
    real dt, tau;   /* s, > 0: the slice, and the integrator's effective step */
    real slip;      /* m/s, > 0: friction is viscous below */
    real far;       /* m, > 0: what would slip farther does not stick yet */
    struct contact *contact; /* [n] out: held, impulse, along, slide, tangent;
                                in: held, along, slide and tangent of the turn
                                before, 0 for a new contact */

    int64_t nv1, n4; /* nv + 1, 4 n */
    int32_t *start;  /* scratch: [nv1] */
    int32_t *item;   /* scratch: [n4] */
    int32_t *vertex; /* scratch: [n4] */
    real *share;     /* scratch: [n] 1/kg, S of §3 */
    real *gave;      /* out: [n] N·s, ≥ 0, §1.2; where friction follows, the
                        load that it follows */
    real *rub;       /* scratch: [n4] weights of friction, §2.4 */
    real *more;      /* scratch: [nv] how many times as much the contacts that
                        stay give of what the vertex got, §1.2 */
    vec *guess;      /* scratch: [nv] m/s, velocity of §1.1 */
    real *parts;     /* scratch: [nv] d, held contacts of a vertex, §2.1 */
    vec *force;      /* out: [nv] N·s, 0 where no contact is held */
    sym *wall;       /* out: [nv] kg, the part of hold of CONTACT_WALL */
    sym *hold;       /* out: [nv] kg, likewise; in, §1.2: of the call before */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex or setting. */
int ref_penalty(struct penalty *s);

/* §1.2: what held contact k has given along its normal, N·s, by w, g and hold;
 * writes share[k], and adds to load what of it its vertices got. */
real penalty_load(struct penalty *s, int64_t k, real load[4]);

/* The contacts' own matrix times a vector, §3.1. */
struct links {
    int64_t nv, n;                 /* vertices, contacts; 4 n < 2^31 */
    const struct contact *contact; /* [n] v, c, n, held, along,
                                      slide */
    real across;                   /* ≥ 0: tau/dt, by which slide counts */
    const vec *x;                  /* [nv] m/s, 0 where w is 0 */

    int64_t nv1, n4;      /* nv + 1, 4 n */
    const int32_t *start; /* [nv1] first item of a vertex, contacts.md §1 */
    const int32_t *item;  /* [n4] 4·contact + corner, by vertex */
    vec *push;            /* scratch: [n] N·s */
    vec *y;               /* inout: [nv] N·s, gains the matrix times x */
};

/* DRAPE_OK, or DRAPE_EARG for counts that do not fit. */
int ref_links(struct links *s);

#endif
