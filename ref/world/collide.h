/* SPDX-License-Identifier: Apache-2.0 */
/* Handles contact in one slice of a step. spec/world/step.md §3, §7 */
#ifndef REF_COLLIDE_H
#define REF_COLLIDE_H

#include "ref/world/state.h"

/* §7.2: tests whether candidates move too far in this slice. If they do, sets
 * *again and shortens the slice that will be tried next. Returns a status. */
int collide_far(struct world *w, drape_step_report *r, double *last,
                bool *again);
/* §3: changes x1 and v1 from the motion without contact to the motion with
 * contact. Returns a status. */
int collide_slice(struct world *w, drape_step_report *r, double *last);

/* The function `broad` of struct response; user is the world. Finds the
 * candidates that have a touched vertex, or all candidates if touched is NULL.
 */
int collide_broad(void *user, const uint8_t *touched, struct pairs *out);

#endif
