/* SPDX-License-Identifier: Apache-2.0 */
/* Stage contacts: impulses with friction. spec/contact/contacts.md */
#ifndef REF_CONTACTS_H
#define REF_CONTACTS_H

#include "ref/contact/contact.h"

/* §1: sleeping contacts and vertices are skipped, as they would not change.
 * SPREAD: an awake vertex whose contacts are all awake. */
enum waking { ASLEEP, AWAKE, SPREAD };

struct contacts {
    int64_t nv, n;  /* vertices, contacts; 4 n < 2^31 */
    const real *w;  /* [nv] 1/kg, ≥ 0; 0: prescribed, never changed */
    int iterations; /* ≥ 0, of the normal and the tangential part */
    int warm;       /* 1: start from the impulses in contact */
    struct contact *contact; /* in, out: [n] impulse and tangent change */
    vec *u;                  /* in, out: [nv] m/s mean velocity of the step */
    vec *v;                  /* in, out: [nv] m/s velocity at its end */

    int64_t nv1, n4; /* nv + 1, 4 n */
    int32_t *start;  /* scratch: [nv1] */
    int32_t *item;   /* scratch: [n4] */
    int32_t *acting; /* scratch: [nv] contacts of a vertex that act */
    int32_t *parts;  /* scratch: [nv] d, parts of a vertex */
    real *lack;      /* scratch: [n] m/s */
    real *lookahead; /* scratch: [n] N·s, y of §3: the impulses that u has */
    real keep;       /* scratch: factor of momentum for the next y, §3 */
    vec *push;       /* scratch: [n] N·s, to be added to u or v */
    vec *before;     /* scratch: [n] N·s, impulse when the call began */
    uint8_t *contact_awake; /* scratch: [n] enum waking, of contacts */
    uint8_t *vertex_awake;  /* scratch: [nv] enum waking, of vertices */
    int32_t *vertex;        /* out: [n4] free vertices in contact, ascending */
    uint8_t *moved;         /* out: [n4] 1 where vertex[k] was pushed */
    int64_t vertices;       /* out: length of vertex and of moved */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex, iterations or nv1, n4. */
int ref_contacts(struct contacts *s);

#endif
