/* SPDX-License-Identifier: Apache-2.0 */
/* Stage cones: proves which patches of cloth cannot touch themselves.
 * spec/broad/cones.md */
#ifndef REF_CONES_H
#define REF_CONES_H

#include "ref/broad/bvtt.h"

/* Bounds of the tangents of all cells of a node over the step, §2: ulo to uhi
 * along i, vlo to vhi along j. */
struct tangents {
    vec ulo, uhi, vlo, vhi; /* m per cell */
};

struct cones {
    struct tree tree;
    struct tree_map map;
    int64_t nv;
    const vec *x0, *x1;  /* [nv] m */
    real r;              /* m, thickness to keep, 0 ≤ r ≤ 2^60 */
    const uint8_t *stir; /* [tree.n_cloth] 0: no vertex of the node has moved
                            since tangents and clear were made */
    int64_t n_inner;     /* inner nodes of cloth; they follow the leaves */
    struct tangents *tangents; /* inout: [n_inner] */
    uint8_t *clear;            /* inout: [tree.n_cloth] bits CLEAR_* of
                                  bvtt.h */
};

/* DRAPE_OK, or DRAPE_EDATA for a bad r. */
int ref_cones(struct cones *s);

/* §3: whether these tangent bounds prove that the features of a full patch that
 * share no vertex stay more than r apart. */
bool cones_apart(const struct tangents *b, real r);

#endif
