/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts of each free vertex, in the order of the contacts.
 * spec/contact/contacts.md §1 */
#ifndef REF_INCIDENCE_H
#define REF_INCIDENCE_H

#include "ref/contact/contact.h"

struct incidence {
    int64_t nv, n;                 /* vertices, contacts; 4 n < 2^31 */
    const real *w;                 /* [nv] 1/kg, 0: prescribed */
    const struct contact *contact; /* [n] */
    int32_t *start;                /* out: [nv + 1] first item of a vertex */
    int32_t *item;    /* out: [4 n] 4·contact + corner, by vertex, ascending */
    int32_t *vertex;  /* out: [4 n] free vertices in contact, ascending */
    int64_t vertices; /* out: length of vertex */
};

/* Fills start, item and vertex. Vertex indices must be valid. */
void ref_incidence(struct incidence *s);

#endif
