/* SPDX-License-Identifier: Apache-2.0 */
/* Keeps the state at the start of a step, and restores it if the step fails in
 * a later slice or after its last. spec/world/step.md §7 */
#ifndef REF_RESTORE_H
#define REF_RESTORE_H

#include "ref/world/state.h"

/* Keeps a copy of the state as the start of the step. DRAPE_OK or an error. */
int restore_save(struct world *w);
/* Undoes a step that failed: the state is that of its start. */
void restore_start(struct world *w);

#endif
