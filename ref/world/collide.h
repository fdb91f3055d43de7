/* SPDX-License-Identifier: Apache-2.0 */
/* Contact in a slice of a step. spec/world/step.md §3, §7 */
#ifndef REF_COLLIDE_H
#define REF_COLLIDE_H

#include "ref/world/state.h"

/* §7.2: *again: candidates move too far, and a shorter slice is set. */
int collide_far(struct world *w, drape_step_report *r, double *last,
                bool *again);
/* §3: x1, v1 without contact become those with it. */
int collide(struct world *w, drape_step_report *r, double *last);

/* response's broad; user is the world. */
int collide_broad(void *user, const uint8_t *touched, struct pairs *out);

#endif
