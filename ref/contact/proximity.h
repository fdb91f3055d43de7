/* SPDX-License-Identifier: Apache-2.0 */
/* Stage proximity: pairs that are too close. spec/contact/proximity.md */
#ifndef REF_PROXIMITY_H
#define REF_PROXIMITY_H

#include "ref/broad/tree.h"
#include "ref/contact/contact.h"

struct proximity {
    int64_t nv, n;              /* vertices, candidates; 4 n < 2^31 */
    const int32_t *pair;        /* [n][4] v f f f or a a b b */
    const uint8_t *kind;        /* [n] enum contact_kind */
    const vec *x;               /* [nv] m */
    int64_t n_from;             /* nv, or 0 */
    const vec *from;            /* [n_from] m, at the start of the slice: only
                                   pairs that arrive are contacts, §3.5 */
    const real *w;              /* [nv] 1/kg, 0: prescribed */
    struct surfaces surfaces;   /* of the vertices */
    struct one_rings one_rings; /* the triangles around each vertex */
    real dt;                    /* s, > 0 */
    real stiffness;             /* N/m, ≥ 0, of the repulsion spring, §4 */
    real range; /* > 0: pairs nearer than so many times their thickness are
                   contacts; pairs that arrive were not so near at the start */

    int32_t *at;             /* scratch: [n] */
    int64_t cap;             /* capacity of contact, items */
    struct contact *contact; /* out: [found] in the candidates' order */
    int64_t found;           /* out: contacts, also if beyond cap */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex, kind or dt; DRAPE_EDATA for a
 * position out of range; DRAPE_EFULL where found exceeds cap: then no contact
 * is written. */
int ref_proximity(struct proximity *s);

#endif
