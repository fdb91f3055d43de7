/* SPDX-License-Identifier: Apache-2.0 */
/* Stage front: where the walk through pairs of nodes stops, kept from query
 * to query. spec/broad/front.md */
#ifndef REF_FRONT_H
#define REF_FRONT_H

#include "ref/broad/bvtt.h"

struct front {
    struct bvtt in;
    int64_t stop;        /* deferral: pairs of levels ≤ stop stay whole */
    int64_t cap;         /* room for pairs, ≥ 1 */
    int64_t n;           /* inout: pairs in the front, ≤ cap */
    int32_t (*pair)[2];  /* inout: [cap] nodes; on failure undefined */
    int32_t (*other)[2]; /* scratch: [cap] */
    uint8_t *act;        /* scratch: [cap] what becomes of a pair */
    uint8_t *act_other;  /* scratch: [cap] */
    int64_t *sum;        /* scratch: [cap] counts of blocks */
    int64_t need;        /* out: pairs that a pass would have written */
    int64_t visited;     /* out: pairs that were tested */
};

/* DRAPE_OK; DRAPE_EDATA for a bad r; DRAPE_EFULL: need > cap, and the caller
 * begins again from the roots with more room: the result is the same (§3). */
int ref_front(struct front *s);

#endif
