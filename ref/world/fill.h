/* SPDX-License-Identifier: Apache-2.0 */
/* Fills a world from a checked definition. */
#ifndef REF_FILL_H
#define REF_FILL_H

#include "ref/world/state.h"

/* Sets the numbers of vertices and triangles, and where those of each body
 * begin. DRAPE_EARG and a text if a cloth's grid is not valid. */
int fill_sizes(struct world *w, const drape_def *def, drape_error *error);
/* Copies the motions. A lack of memory is recorded in the arena. */
void fill_motions(struct world *w, const drape_def *def);
/* Takes the streams of the state and fills them for time 0. DRAPE_OK, or an
 * error and a text. */
int fill_streams(struct world *w, const drape_def *def, drape_error *error);

#endif
