/* SPDX-License-Identifier: Apache-2.0 */
/* The two orders of stage audit. spec/narrow/audit.md §4 */
#ifndef REF_AUDIT_SORT_H
#define REF_AUDIT_SORT_H

#include "ref/narrow/audit.h"

struct audit_box {
    vec lo, hi;
};

struct audit_box ref_audit_box(const struct audit *s, int64_t t);

/* Order[0]: triangles of group 0 first, each group along a Morton curve. */
void ref_audit_order(struct audit *s);

/* Sorts n pairs ascending. */
void ref_audit_sort(int32_t (*pair)[2], int64_t n);

#endif
