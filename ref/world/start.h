/* SPDX-License-Identifier: Apache-2.0 */
/* Checks whether a scene may start in the state that its definition gives. */
#ifndef REF_START_H
#define REF_START_H

#include "ref/world/state.h"

/* Counts the intersecting pairs that the simulation must keep apart; the count
 * is part of the state. DRAPE_ESTART and the first pair in words if there is a
 * pair and the scene does not allow it. */
int start_audit(struct world *w, drape_error *error);
/* The same for vertices at x [nv], on the host, and the count goes to *found.
 * body: pairs of which no side is of this body are counted and not refused; -1:
 * all are refused. w is a world whose streams are on the host. */
int start_audit_at(struct world *w, const vec *x, int body, int64_t *found,
                   drape_error *error);

/* DRAPE_OK, or DRAPE_ELIMIT and a text if an explicit method needs more
 * substeps than max_substeps. */
int start_substeps(const struct world *w, drape_error *error);
/* Whether an explicit method needs more than max_substeps for a cloth with
 * these constants. */
bool start_too_stiff(const struct world *w, const struct cloth *cloth);

#endif
