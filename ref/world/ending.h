/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether the state at the end of a step intersects.
 * spec/world/step.md §11 */
#ifndef REF_ENDING_H
#define REF_ENDING_H

#include "ref/world/state.h"

/* Whether the state may intersect after slices with this outcome, so that its
 * pairs must be counted. */
static inline bool ending_doubtful(const struct world *w, int outcome)
{
    return w->intersecting > 0 || (outcome & DRAPE_TRAPPED);
}

/* Writes the number of intersecting pairs of the scene's triangles, with their
 * vertices at x [nv] in the backend's memory, to *found. DRAPE_OK or
 * DRAPE_ENOMEM. */
int ending_count(struct world *w, const vec *x, int64_t *found);

/* Sets the report's `intersecting` and the outcomes TRAPPED and PASSED from
 * w->intersecting. */
void ending_tell(const struct world *w, drape_step_report *r);

#endif
