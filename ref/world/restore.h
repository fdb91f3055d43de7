/* SPDX-License-Identifier: Apache-2.0 */
/* What a step goes back to that fails in a later slice, or behind the last.
 * spec/world/step.md §7 */
#ifndef REF_RESTORE_H
#define REF_RESTORE_H

#include "ref/world/state.h"

/* Keeps the state as the start of the step. DRAPE_OK or an error. */
int restore_save(struct world *w);
/* The state is the start of the step again. */
void restore_start(struct world *w);

#endif
