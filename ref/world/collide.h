/* SPDX-License-Identifier: Apache-2.0 */
/* Contact in a slice of a step. spec/world/step.md §3, §7 */
#ifndef REF_COLLIDE_H
#define REF_COLLIDE_H

#include "ref/world/state.h"

/* Adds the time since *last to a part of the report, but for the seconds
 * within that are another part's. */
void step_charge(drape_step_report *r, enum drape_part part, double *last,
                 double within);

/* The square of the longest way of the first n vertices, m². */
real collide_furthest(const struct world *w, int64_t n);
/* §7.2: *again: candidates move too far, and a shorter slice is set. */
int collide_far(struct world *w, drape_step_report *r, double *last,
                bool *again);
/* §3: x1, v1 without contact become those with it. */
int collide(struct world *w, drape_step_report *r, double *last);

#endif
