/* SPDX-License-Identifier: Apache-2.0 */
/* Fills a world from a checked definition. */
#ifndef REF_FILL_H
#define REF_FILL_H

#include "ref/world/state.h"

/* Sets how many vertices and triangles there are, and where each body's begin.
 * DRAPE_EARG and a text for a cloth that cannot be. */
int fill_sizes(struct world *w, const drape_def *def, drape_error *error);
/* Copies the motions; short memory shows in the arena. */
void fill_motions(struct world *w, const drape_def *def);
/* Takes the streams and writes what a world starts with. DRAPE_OK, or an error
 * and a text. */
int fill_streams(struct world *w, const drape_def *def, drape_error *error);

#endif
