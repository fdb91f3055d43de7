/* SPDX-License-Identifier: Apache-2.0 */
/* Stage refit: fits the boxes of the BVH to the positions of a step.
 * spec/broad/refit.md */
#ifndef REF_REFIT_H
#define REF_REFIT_H

#include "ref/broad/box.h"
#include "ref/broad/tree.h"

struct refit {
    struct tree tree;
    int64_t nv;           /* vertices */
    const vec *x0, *x1;   /* [nv] m, start and end of the step, |x| ≤ 2^60 */
    int64_t n_moved;      /* nv, or 0: all vertices have moved */
    const uint8_t *moved; /* [n_moved] 0: the vertex has not moved since
                             `box` was made */
    int64_t all;          /* 0: boxes of static meshes are kept */
    int64_t every;        /* 1: boxes of other meshes are made where nothing
                             has moved, too */
    struct box *box;      /* inout: [tree.n] m */
    uint8_t *stir;        /* inout: [tree.n] 1: a vertex of the node moved */
    int64_t made;         /* out: boxes made */
};

/* DRAPE_OK, or DRAPE_EDATA if a position is NaN or out of range. */
int ref_refit(struct refit *s);

#endif
