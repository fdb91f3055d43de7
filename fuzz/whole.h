/* SPDX-License-Identifier: Apache-2.0 */
/* Draws a whole definition from choices. Any field may be invalid, but every
 * array has the size that its counts say. */
#ifndef FUZZ_WHOLE_H
#define FUZZ_WHOLE_H

#include "fuzz/draw.h"

enum { WHOLE_MOST = 3 }; /* largest number each of cloths, obstacles, motions */

struct whole {
    drape_def def;
    drape_cloth cloth[WHOLE_MOST];
    drape_obstacle obstacle[WHOLE_MOST];
    drape_motion motion[WHOLE_MOST];
    struct shelf shelf; /* the arrays */
};

/* Draws a definition; most definitions use the bank's memory. */
void whole_make(struct whole *w, struct bytes *b, struct bank *bank);
void whole_free(struct whole *w);

#endif
