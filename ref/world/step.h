/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step. */
#ifndef REF_STEP_H
#define REF_STEP_H

#include "ref/world/state.h"

/* As drape_step; report may be NULL. Negative: nothing has changed. */
int step_advance(struct world *w, drape_step_report *report);

#endif
