/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a scene may start as it is. */
#ifndef REF_START_H
#define REF_START_H

#include "ref/world/state.h"

/* Counts the intersecting pairs that the simulation is to keep apart, as part
 * of the state. DRAPE_ESTART and the first of them in words where there are
 * some and the scene does not allow that. */
int start_audit(struct world *w, drape_error *error);

/* DRAPE_ELIMIT and a text where an explicit method would need more substeps
 * than it may make. */
int start_substeps(const struct world *w, drape_error *error);

#endif
