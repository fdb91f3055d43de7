/* SPDX-License-Identifier: Apache-2.0 */
/* Leads obstacles and pins. spec/world/step.md §1 */
#ifndef REF_LEAD_H
#define REF_LEAD_H

#include "ref/world/state.h"

/* Puts obstacles and pins where they are at time t: x [nv] gets the
 * obstacles, w->to the pins. DRAPE_OK or DRAPE_EDATA. */
int lead(struct world *w, double t, vec *x);
/* Whether any of them is elsewhere in x1 than in x0. */
bool lead_moves(const struct world *w);
/* v1 of the obstacles: their mean velocity. */
void lead_velocities(const struct world *w);

#endif
