/* SPDX-License-Identifier: Apache-2.0 */
/* Sorts the triangles of stage audit along a Morton curve, and sorts its pairs.
 * spec/narrow/audit.md §4 */
#ifndef REF_AUDIT_SORT_H
#define REF_AUDIT_SORT_H

#include "ref/narrow/audit.h"

struct audit_box {
    vec lo, hi;
};

struct audit_box ref_audit_box(const struct audit *s, int64_t t);

/* Fills s->order[0] with the triangles of group 0 first, each group along a
 * Morton curve (§4.1). */
void ref_audit_order(struct audit *s);

/* Sorts n pairs ascending (§4.4). */
void ref_audit_sort(int32_t (*pair)[2], int64_t n);

#endif
