/* SPDX-License-Identifier: Apache-2.0 */
/* Stage coulomb: the impulses of contacts at given velocities, by an augmented
 * Lagrangian of non-penetration and of Coulomb's law, and their matrix. Stage
 * links: this matrix times a vector. spec/contact/coulomb.md */
#ifndef REF_COULOMB_H
#define REF_COULOMB_H

#include "ref/contact/contact.h"

/* §2.3: λ rises steadily where it rises by more than this part of its last
 * rise; κ is then multiplied. */
#define COULOMB_STEADY R(0.9)
#define COULOMB_GROWTH R(3.0)

struct coulomb {
    int64_t nv, nc, n; /* vertices, of which the first nc are particles of
                          cloths; contacts; 4 n < 2^31 */
    const real *w;     /* [nv] 1/kg, ≥ 0; 0: prescribed */
    const vec *u;      /* [nv] m/s, mean velocity of the slice */
    const vec *rest;   /* [nc] N·s, residual of the motion without contact */
    real dt, tau;      /* s, > 0: the slice, and the integrator's effective
                          step */
    real stiffest;     /* kg, > 0: no κ grows beyond */
    real give;     /* 1/(kg m), ≥ 0: compliance of a contact over its gap */
    real reach;    /* m, ≥ 0: no thickness is larger */
    int renews;    /* 1: the multipliers become the impulses of the last call */
    int64_t seams; /* 0 … n: the last `seams` contacts are points of seams, of
                      which n is the target, m/s, tangent the pull, N·s, and
                      load its bound, 0: none; seam.md §2 */
    int64_t hinges; /* 0 … seams: the last of these have no multiplier;
                       seam.md §6 */
    int knits;      /* 1: bound is without contacts of seams that move several
                       vertices, as multigrid has these; sewn.md */
    int closes;     /* 1: N becomes the normal impulse of this call */
    int lists;      /* 1: the contacts are others than in the call before */
    struct contact *contact; /* [n] inout; carry.md has set them up */

    int64_t nv1, n4; /* nv + 1, 4 n */
    int32_t *start;  /* inout: [nv1] the lists of contacts.md §1, made where
                        lists is 1 */
    int32_t *item;   /* inout: [n4] likewise */
    int32_t *vertex; /* inout: [n4] likewise */
    vec *next;       /* scratch: [n] N·s, impulses by renewed multipliers */
    vec *force;      /* out: [nv] N·s, Σ c (p n + pt) */
    vec *inner;      /* out: [nc] N·s, rest + force, 0 where fixed */
    vec *outer;      /* out: [nc] N·s, the same by renewed multipliers */
    sym *single;     /* out: [nv] kg, the part of bound of CONTACT_SINGLE */
    sym *bound;      /* out: [nv] kg, a bound of the contacts' matrix */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex, setting or count. */
int ref_coulomb(struct coulomb *s);

/* The contacts' own matrix times a vector, §3.1. */
struct links {
    int64_t nv, n; /* vertices, contacts; 4 n < 2^31 */
    const struct contact
        *contact; /* [n] v, c, n, coupling, stiffness_n, stiffness_t, way */
    const vec *x; /* [nv] m/s, 0 where w is 0 */

    int64_t nv1, n4;      /* nv + 1, 4 n */
    const int32_t *start; /* [nv1] first item of a vertex, contacts.md §1 */
    const int32_t *item;  /* [n4] 4·contact + corner, by vertex */
    vec *push;            /* scratch: [n] N·s */
    vec *y;               /* inout: [nv] N·s, gains the matrix times x */
};

/* DRAPE_OK, or DRAPE_EARG for counts that do not fit. */
int ref_links(struct links *s);

#endif
