/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2 of the narrow phase: subdivides [0, 1] in binary64.
 * spec/narrow/narrow.md §5 */
#ifndef REF_SPLIT_H
#define REF_SPLIT_H

#include "ref/narrow/filter.h"

/* Runs tier 2 (§5). Returns FILTER_MISS, FILTER_HIT with the exact *toi, or
 * FILTER_UNSURE with a lower bound in *toi. */
/*@ requires 3 <= m->count <= 4;
  @ requires \forall integer k; 0 <= k < 3 ==>
  @     0x1p-800 <= s->eq[k] <= 0x1p400 && 0x1p-800 <= s->eb[k] <= 0x1p200;
  @ requires \forall integer j, t, k;
  @     0 <= j < m->count && 0 <= t < 2 && 0 <= k < 3 ==>
  @     -0x1p202 <= m->box[j].at[t][k] <= 0x1p202;
  @ requires \forall integer j, k, i;
  @     0 <= j < m->count && 0 <= k < 3 && 0 <= i < 3 ==>
  @     -0x1p403 <= s->q[j][k][i] <= 0x1p403;
  @ requires 0x1p-800 <= s->ev <= 0x1p700;
  @ requires \forall integer i; 0 <= i < 4 ==>
  @     -0x1p700 <= s->v[i] <= 0x1p700; */
int split_interval(const struct motion *m, const struct forms *s,
                   uint32_t *toi);

#endif
