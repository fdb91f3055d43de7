/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the state that a step ends in intersects. spec/world/step.md §11 */
#ifndef REF_ENDING_H
#define REF_ENDING_H

#include "ref/world/state.h"

/* Whether the state may intersect after slices with this outcome. */
static inline bool ending_doubtful(const struct world *w, int outcome)
{
    return w->intersecting > 0 || (outcome & DRAPE_TRAPPED);
}

/* Counts the intersecting pairs of x0 into *found. DRAPE_OK or DRAPE_ENOMEM. */
int ending_count(struct world *w, int64_t *found);

/* Sets what the report says of intersections, from the state as it is. */
void ending_tell(const struct world *w, drape_step_report *r);

#endif
