/* SPDX-License-Identifier: Apache-2.0 */
/* Stage walk: traverses the BVTT from the front down to pairs of triangles.
 * spec/broad/walk.md */
#ifndef REF_WALK_H
#define REF_WALK_H

#include "ref/broad/bvtt.h"

struct walk {
    struct bvtt in;
    int64_t nv;
    const vec *x0, *x1;        /* [nv] m */
    const uint8_t *stir;       /* [in.tree.n] spec/broad/refit.md §4 */
    int64_t n_front;           /* ≤ cap */
    const int32_t (*front)[2]; /* [n_front] nodes */
    int64_t cap;               /* capacity for node pairs of one pass, ≥ 1 */
    int32_t (*pair)[2];        /* scratch: [cap] */
    int32_t (*other)[2];       /* scratch: [cap] */
    uint16_t *mask;            /* scratch: [cap] children that pass */
    int64_t *sum;              /* scratch: [cap] a count for each block */
    int64_t cap_tri;           /* capacity for triangle pairs */
    int32_t (*tri)[2];         /* out: [cap_tri] triangles whose boxes meet */
    int64_t n_tri;             /* out: ≤ cap_tri */
    int64_t need;              /* out: node pairs that a pass would hold */
    int64_t need_tri;          /* out: triangle pairs there are */
    int64_t visited;           /* out: node pairs visited */
    int64_t cleared;           /* out: node pairs that only cones rejected */
};

/* DRAPE_OK; DRAPE_EDATA for a bad r; DRAPE_EFULL if need > cap or need_tri >
 * cap_tri. */
int ref_walk(struct walk *s);

#endif
