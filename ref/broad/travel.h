/* SPDX-License-Identifier: Apache-2.0 */
/* Stage travel: finds the largest relative motion of the two primitives of any
 * candidate, so that a step with too much of it can be cut into slices.
 * spec/broad/travel.md */
#ifndef REF_TRAVEL_H
#define REF_TRAVEL_H

#include "ref/broad/pair.h"

struct travel {
    int64_t nv, n;       /* vertices, candidates */
    const int32_t *pair; /* [n][4] v f f f or a a b b */
    const uint8_t *kind; /* [n] enum contact_kind */
    const vec *x0, *x1;  /* [nv] m, finite */

    real most; /* out: m², largest squared relative motion; 0 without
                  candidates */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex or kind. */
int ref_travel(struct travel *s);

#endif
