/* SPDX-License-Identifier: Apache-2.0 */
/* Stage refit: the boxes of the tree's nodes. spec/broad/refit.md */
#ifndef REF_REFIT_H
#define REF_REFIT_H

#include "ref/broad/box.h"
#include "ref/broad/tree.h"

struct refit {
    struct tree tree;
    int64_t nv;           /* vertices */
    const vec *x0, *x1;   /* [nv] m, start and end of the step, |x| ≤ 2^60 */
    int64_t n_moved;      /* nv, or 0: all have moved */
    const uint8_t *moved; /* [n_moved] 0: x0 and x1 are as in the last refit,
                             of which box is */
    int64_t all;          /* 0: nodes of static meshes are left as they are */
    struct box *box;      /* inout: [tree.n] m */
    uint8_t *stir;        /* inout: [tree.n] 1: a vertex of it has moved */
    int64_t made;         /* out: boxes made */
};

/* DRAPE_OK, or DRAPE_EDATA if a position is NaN or out of range. */
int ref_refit(struct refit *s);

#endif
