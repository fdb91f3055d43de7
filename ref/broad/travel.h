/* SPDX-License-Identifier: Apache-2.0 */
/* Stage travel: how far candidates move beside one another.
 * spec/broad/travel.md */
#ifndef REF_TRAVEL_H
#define REF_TRAVEL_H

#include "ref/contact/contact.h"

struct travel {
    int64_t nv, n;       /* vertices, candidates */
    const int32_t *pair; /* [n][4] v f f f or a a b b */
    const uint8_t *kind; /* [n] enum contact_kind */
    const vec *x0, *x1;  /* [nv] m, finite */

    real most; /* out: m², the square of the largest way, 0 of none */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex or kind. */
int ref_travel(struct travel *s);

#endif
