/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step. */
#ifndef REF_STEP_H
#define REF_STEP_H

#include "ref/world/state.h"

/* Does what drape_step says. After a negative status the state is as before. */
int step_advance(struct world *w, drape_step_report *report);

#endif
