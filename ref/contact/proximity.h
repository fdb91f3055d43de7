/* SPDX-License-Identifier: Apache-2.0 */
/* Stage proximity: pairs that are too close. spec/contact/proximity.md */
#ifndef REF_PROXIMITY_H
#define REF_PROXIMITY_H

#include "ref/broad/tree.h"
#include "ref/contact/contact.h"

struct proximity {
    int64_t nv, n;       /* vertices, candidates; 4 n < 2^31 */
    const int32_t *pair; /* [n][4] v f f f or a a b b */
    const uint8_t *kind; /* [n] enum contact_kind */
    const vec *x;        /* [nv] m, at the start of the step */
    const real *w;       /* [nv] 1/kg, 0: led */
    struct skin skin;    /* of the vertices */
    struct fan fan;      /* the triangles around each vertex */
    real dt;             /* s, > 0 */
    real stiffness;      /* N/m, ≥ 0, of the repulsion spring, §4 */

    int32_t *at;             /* scratch: [n] */
    int64_t cap;             /* capacity of contact, items */
    struct contact *contact; /* out: [found] in the candidates' order */
    int64_t found;           /* out: contacts, also if beyond cap */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex, kind or dt; DRAPE_EDATA for a
 * position out of range; DRAPE_EFULL where found exceeds cap: then no contact
 * is written. */
int ref_proximity(struct proximity *s);

/* Stage ahead: contacts of where the step ends. spec/contact/ahead.md */
struct ahead {
    int64_t nv, n, n_new; /* vertices; contacts at the start and at the end */
    const real *w;        /* [nv] 1/kg, 0: led */
    struct skin skin;     /* of the vertices */
    const vec *u;         /* [nv] m/s, mean velocity of the step so far */
    real dt;              /* s, > 0 */
    const uint8_t *met;   /* [nv] 1: met something on the way */
    const struct contact *before; /* [n] of proximity at x0 */
    const struct contact *after;  /* [n_new] of proximity at x0 + dt u */

    int64_t nv1, n4, n_all;  /* nv + 1, 4 n, n + n_new */
    int32_t *start;          /* scratch: [nv1] */
    int32_t *item;           /* scratch: [n4] */
    int32_t *vertex;         /* scratch: [n4] */
    real *height;            /* scratch: [nv] m, §2; < 0: not known */
    int32_t *at;             /* scratch: [n_all] */
    struct contact *contact; /* out: [found], capacity n_all */
    int64_t found;           /* out */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex, dt or count. */
int ref_ahead(struct ahead *s);

#endif
