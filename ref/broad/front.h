/* SPDX-License-Identifier: Apache-2.0 */
/* Stage front: updates the BVTT front, the pairs of nodes at which the
 * traversal stopped. The front is kept from query to query, so that a query
 * does not begin at the roots. spec/broad/front.md */
#ifndef REF_FRONT_H
#define REF_FRONT_H

#include "ref/broad/bvtt.h"

struct front {
    struct bvtt in;
    int64_t stop;        /* pairs of levels ≤ stop are not split, §5 */
    int64_t cap;         /* capacity for pairs, ≥ 1 */
    int64_t n;           /* inout: pairs in the front, ≤ cap */
    int32_t (*pair)[2];  /* inout: [cap] nodes; undefined on failure */
    int32_t (*other)[2]; /* scratch: [cap] */
    uint8_t *act;        /* scratch: [cap] TEST, KEEP or SPLIT */
    uint8_t *act_other;  /* scratch: [cap] */
    int64_t *sum;        /* scratch: [cap] a count for each block */
    int64_t need;        /* out: capacity that the last pass needed */
    int64_t visited;     /* out: pairs tested */
};

/* DRAPE_OK; DRAPE_EDATA for a bad r; DRAPE_EFULL if need > cap. After
 * DRAPE_EFULL the caller begins again from the roots with a larger capacity,
 * which gives the same front (§3). */
int ref_front(struct front *s);

#endif
