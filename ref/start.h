/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a scene may start as it is. */
#ifndef REF_START_H
#define REF_START_H

#include "ref/state.h"

/* DRAPE_OK, or DRAPE_ESTART and how many pairs of triangles intersect that
 * the simulation is to keep apart. */
int start_audit(struct world *w, drape_error *error);

#endif
