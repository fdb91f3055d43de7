/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the seams of a world, on the host. spec/seam/seam.md */
#ifndef REF_SEAM_H
#define REF_SEAM_H

#include "ref/world/state.h"

/* Sets how many points the seams have. */
void sew_size(struct world *w, const drape_def *def);
/* Makes the points of the seams at x0, and the lists of §5. The streams of the
 * state have been taken. DRAPE_OK, DRAPE_ENOMEM, or DRAPE_EARG and a text. */
int sew_fill(struct world *w, const drape_def *def, drape_error *error);
/* Lists the seams on the grids of multigrid: sewn.md §1. DRAPE_OK or
 * DRAPE_ENOMEM. */
int sew_grids(struct world *w, const drape_def *def);
/* The stiffnesses of the points, after a material was set. */
void sew_stiffen(struct world *w);
/* §5: whether triangles a and b of the scene are sewn together. */
bool sew_joins(const struct world *w, int32_t a, int32_t b);

#endif
