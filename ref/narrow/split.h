/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2 of the narrow phase: subdivides [0, 1] in binary64.
 * spec/narrow/narrow.md §5 */
#ifndef REF_SPLIT_H
#define REF_SPLIT_H

#include "ref/narrow/filter.h"

/* Runs tier 2 (§5). Returns FILTER_MISS, FILTER_HIT with the exact *toi, or
 * FILTER_UNSURE with a lower bound in *toi. */
int split_interval(const struct motion *m, const struct forms *s,
                   uint32_t *toi);

#endif
