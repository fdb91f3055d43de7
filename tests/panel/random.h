/* SPDX-License-Identifier: Apache-2.0 */
/* Random panels for scenes. */
#ifndef TESTS_RANDOM_H
#define TESTS_RANDOM_H

#include "tests/base/harness.h"

enum { RANDOM_SIDE = 14 }; /* particles along a side, at most */

struct random_panel {
    drape_panel panel;
    double rest[RANDOM_SIDE * RANDOM_SIDE][2];
    uint8_t cell[(RANDOM_SIDE - 1) * (RANDOM_SIDE - 1)];
};

/* Makes a cloth a panel in which some particles are moved, some cells are
 * missing, and others are triangles, with or without a moved corner. All
 * triangles are large enough. */
void random_panel(struct bytes *b, drape_cloth *c, struct random_panel *s);

#endif
