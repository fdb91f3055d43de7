/* SPDX-License-Identifier: Apache-2.0 */
/* Moves obstacles and pins to their prescribed places. spec/world/step.md §1 */
#ifndef REF_PRESCRIBE_H
#define REF_PRESCRIBE_H

#include "ref/world/state.h"

/* Writes the places at time t, in s: those of obstacles to x [nv], those of
 * pins to w->to. DRAPE_OK, DRAPE_EDATA if one is beyond 2^60, or an error of
 * the backend. */
int prescribe_positions(struct world *w, double t, vec *x);
/* Whether an obstacle or a pin has another place in x1 than in x0. */
bool prescribe_moves(const struct world *w);
/* Sets v1 of the obstacles to their mean velocity over the slice. */
void prescribe_velocities(const struct world *w);

#endif
