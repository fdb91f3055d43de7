/* SPDX-License-Identifier: Apache-2.0 */
/* Stage carry: contacts get the multipliers of the slice before, by their keys,
 * and the other numbers that stage coulomb needs. Stage retain lists the
 * multipliers that the next slice may carry on. spec/contact/carry.md */
#ifndef REF_CARRY_H
#define REF_CARRY_H

#include "ref/contact/contact.h"

/* §1.1: the part of an overlap that goes in a slice. */
#define CARRY_RISE R(0.1)
/* §1.2: κ, in the masses that the contact moves. */
#define CARRY_KAPPA R(30.0)

/* The multipliers of a pair's contact at the end of a slice. */
struct kept {
    uint64_t hi, lo; /* the pair's key, impulses.md §1 */
    real lambda;     /* N·s, ≥ 0 */
    vec lambda_t;    /* N·s, on side A as the key orders the sides */
};

struct carry {
    int64_t nv, n, n_kept;    /* vertices, contacts, entries kept; 4 n < 2^31 */
    const real *w;            /* [nv] 1/kg, ≥ 0; 0: prescribed */
    struct surfaces surfaces; /* of the vertices */
    real dt, tau;             /* s, > 0: the slice, and the integrator's
                                 effective step */
    real stiffest;            /* kg, > 0: the largest κ that a load asks for */
    const struct kept *kept;  /* [n_kept] by key, ascending */
    struct contact *contact;  /* [n] inout: target; of those whose kappa is 0
                                 lambda, lambda_t, load and kappa, too */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex or setting. */
int ref_carry(struct carry *s);
/* The entry of kept [n], by key, of a contact's pair, or NULL. */
const struct kept *carry_find(const struct kept *kept, int64_t n,
                              const struct contact *c);

struct retain {
    int64_t nv, n;    /* vertices, contacts */
    const real *w;    /* [nv] 1/kg, ≥ 0; 0: prescribed */
    const vec *u, *v; /* [nv] m/s: mean velocity of the slice, and velocity at
                         its start */
    real most;        /* m/s, ≥ 0: a side that a contact changes by more was
                         struck by it */
    const struct contact *contact; /* [n] by key, ascending */
    struct kept *kept;             /* out: [n] in this order */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex or setting. */
int ref_retain(struct retain *s);

/* §2: whether a contact of this slice struck a side of it. */
bool carry_struck(const struct retain *s, const struct contact *c);

#endif
