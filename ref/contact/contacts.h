/* SPDX-License-Identifier: Apache-2.0 */
/* Stage contacts: impulses with friction. spec/contact/contacts.md */
#ifndef REF_CONTACTS_H
#define REF_CONTACTS_H

#include "ref/contact/contact.h"

/* §1: what takes part. Others cannot change anything. */
enum waking { ASLEEP, AWAKE, SPREAD }; /* SPREAD: woke all of its contacts */

struct contacts {
    int64_t nv, n;           /* vertices, contacts; 4 n < 2^31 */
    const real *w;           /* [nv] 1/kg, ≥ 0; 0: led, never changed */
    int iterations;          /* ≥ 0, of the normal and of the tangent part */
    int warm;                /* 1: go on from the impulses in contact */
    struct contact *contact; /* in, out: [n] impulse and tangent change */
    vec *u;                  /* in, out: [nv] m/s mean velocity of the step */
    vec *v;                  /* in, out: [nv] m/s velocity at its end */

    int64_t nv1, n4;  /* nv + 1, 4 n */
    int32_t *start;   /* scratch: [nv1] */
    int32_t *item;    /* scratch: [n4] */
    int32_t *acting;  /* scratch: [nv] contacts of a vertex that act */
    int32_t *parts;   /* scratch: [nv] d, into how many it is split */
    real *lack;       /* scratch: [n] m/s */
    real *ahead;      /* scratch: [n] N·s, y of §3: where u is */
    real keep;        /* scratch: of §3, how far y goes */
    vec *push;        /* scratch: [n] */
    vec *before;      /* scratch: [n] */
    uint8_t *awake;   /* scratch: [n] enum waking */
    uint8_t *stirred; /* scratch: [nv] enum waking, of vertices */
    int32_t *vertex;  /* out: [n4] free vertices in contact, ascending */
    uint8_t *moved;   /* out: [n4] of vertex: 1 where anything pushed it */
    int64_t vertices; /* out: how many */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex, iterations or nv1, n4. */
int ref_contacts(struct contacts *s);

#endif
