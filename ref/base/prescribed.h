/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference over prescribed vertices and over displacements. The
 * device has the same in gpu/world/prescribed.cu. spec/world/step.md §1, §6, §7
 */
#ifndef REF_PRESCRIBED_H
#define REF_PRESCRIBED_H

#include "ref/base/backend.h"
#include "ref/base/stage.h"

/* A part of the straight way of n items to their targets. */
struct blend {
    int64_t n;
    const int32_t *at;    /* [n] the vertex of each item; NULL: the item */
    const vec *from, *to; /* m, by vertex */
    double part;          /* of the way, 0 … 1; 1: `to` itself */
    vec *x;               /* out: [n] m, by item */
};

#endif
