/* SPDX-License-Identifier: Apache-2.0 */
/* Sorts the triangles of stage audit along a Morton curve, and sorts its pairs.
 * spec/narrow/audit.md §4 */
#ifndef REF_AUDIT_SORT_H
#define REF_AUDIT_SORT_H

#include "ref/base/stage.h"

struct audit_box {
    vec lo, hi;
};

/* The box of the triangle with the vertices v. */
struct audit_box ref_audit_box(const vec *x, const int32_t v[3]);

/* A mesh and the buffers in which its triangles are sorted; struct audit has
 * the same members. */
struct audit_order {
    int64_t nv, nt;
    const vec *x;
    const int32_t (*tri)[3];
    const int32_t *group; /* [nt] or NULL */
    uint64_t **key;       /* scratch: [2][nt] */
    int32_t **order;      /* out: order[0]; scratch: order[1]; [nt] each */
};

/* Fills s->order[0] with the triangles of group 0 first, each group along a
 * Morton curve (§4.1). */
void ref_audit_order(const struct audit_order *s);

/* Sorts n pairs ascending (§4.4). */
void ref_audit_sort(int32_t (*pair)[2], int64_t n);

#endif
