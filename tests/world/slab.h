/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene for tests of whole steps. */
#ifndef TESTS_SLAB_H
#define TESTS_SLAB_H

#include "tests/base/harness.h"

/* A 24 × 24 sheet falls on a slab that moves; 30 steps. */
struct slab {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle obstacle;
    drape_motion motion;
};

/* The slab's top is at y = 0.1, the sheet starts at rest at y = 0.12. */
void slab_make(struct slab *d, int integrator);
/* Makes the world; NULL if the definition is refused, with the reason printed.
 */
drape_world *slab_world(const struct slab *d);

#endif
