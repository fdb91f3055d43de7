/* SPDX-License-Identifier: Apache-2.0 */
/* The second tier of the narrow phase: spec/narrow/narrow.md §5. */
#ifndef REF_SPLIT_H
#define REF_SPLIT_H

#include "ref/narrow/filter.h"

/* Second tier (§5): FILTER_MISS; FILTER_HIT, *toi canonical; FILTER_UNSURE,
 * *toi a lower bound. */
int filter_split(const struct motion *m, const struct forms *s, uint32_t *toi);

#endif
