/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene for tests of whole steps. */
#ifndef TESTS_SLAB_H
#define TESTS_SLAB_H

#include "ref/base/arena.h"
#include "tests/base/harness.h"

struct world;

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

/* A smaller sheet of SLAB_SMALL × SLAB_SMALL particles at height y. Its cells
 * are 1/64 m, so that rounding exerts no force. */
enum { SLAB_SMALL = 12 };
void slab_small(struct slab *d, int integrator, double y);
/* Makes a world without the public API, for tests that look into it; NULL if
 * the definition is refused. arena_free frees it. */
struct world *slab_inner(const drape_def *def, struct arena *arena);

#endif
