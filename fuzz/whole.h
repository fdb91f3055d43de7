/* SPDX-License-Identifier: Apache-2.0 */
/* A whole definition drawn from choices: any field may be wrong, but every
 * array that is given has the size that its counts say. */
#ifndef FUZZ_WHOLE_H
#define FUZZ_WHOLE_H

#include "fuzz/draw.h"

enum { WHOLE_MOST = 3 }; /* cloths, obstacles, motions each */

struct whole {
    drape_def def;
    drape_cloth cloth[WHOLE_MOST];
    drape_obstacle obstacle[WHOLE_MOST];
    drape_motion motion[WHOLE_MOST];
    struct shelf shelf; /* the arrays */
};

/* Most of them with memory of the bank's. */
void whole_make(struct whole *w, struct bytes *b, struct bank *bank);
void whole_free(struct whole *w);

#endif
