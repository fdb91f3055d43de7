/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene of several bodies, for the tests of bodies that come and go. */
#ifndef TESTS_TROUPE_H
#define TESTS_TROUPE_H

#include "tests/api/guest.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"

enum {
    TROUPE_M = 7,
    TROUPE_N = 6,
    TROUPE_COUNT = TROUPE_M * TROUPE_N,
    TROUPE_PLATE = 4,
    TROUPE_NV = 2 * (TROUPE_COUNT + TROUPE_PLATE),
    TROUPE_INTEGRATORS = 4
};
extern const int troupe_integrators[TROUPE_INTEGRATORS];

/* A sheet with a hole, a cut and pins that falls onto a plate, one above it,
 * and a second plate beside; there is wind. Bodies 0 and 1 are the sheets. By
 * integrators of second order sheet 1 is a panel, and by BDF2 a seam holds its
 * corner to sheet 0. */
struct troupe {
    drape_def def;
    drape_cloth cloth[2];
    drape_obstacle obstacle[2];
    drape_motion motion;
    drape_seam seam;
};

void troupe_make(struct troupe *t, int integrator, int backend);
/* Makes obstacle k one that moves: by the motion, or by frames. */
void troupe_move(struct troupe *t, int k, bool frames);
/* Takes a body out of the definition, and of sheets the seam. */
void troupe_drop(struct troupe *t, int body);
/* Makes a world; a troupe may have been copied before. NULL: it is refused. */
drape_world *troupe_world(const struct troupe *t);

#endif
