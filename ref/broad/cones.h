/* SPDX-License-Identifier: Apache-2.0 */
/* Stage cones: which patches of cloth cannot touch themselves.
 * spec/broad/cones.md */
#ifndef REF_CONES_H
#define REF_CONES_H

#include "ref/broad/bvtt.h"

/* Bounds of the tangents of a node's cells over the step, §2. */
struct tangents {
    vec ulo, uhi, vlo, vhi; /* m a cell */
};

struct cones {
    struct tree tree;
    struct tree_map map;
    int64_t nv;
    const vec *x0, *x1;  /* [nv] m */
    real r;              /* m, distance that must be kept, 0 ≤ r ≤ 2^60 */
    const uint8_t *stir; /* [tree.n_cloth] 0: none of its vertices has
                            moved since tangents and clear were made */
    int64_t n_inner;     /* cloth nodes that are no leaves; they follow */
    struct tangents *tangents; /* inout: [n_inner] */
    uint8_t *clear;            /* inout: [tree.n_cloth] bits of enum, bvtt.h */
};

/* DRAPE_OK, or DRAPE_EDATA for a bad r. */
int ref_cones(struct cones *s);

/* §3: whether such tangents keep every two points of a patch apart. */
bool cones_apart(const struct tangents *b, real r);

#endif
