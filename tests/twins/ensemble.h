/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene in which all happens that a world must remember, for tests that
 * run a world beside one that stopped, failed, slept or was made anew. */
#ifndef TESTS_ENSEMBLE_H
#define TESTS_ENSEMBLE_H

#include "tests/world/slab.h"

/* Four cloths, in three groups that are far apart: one slides on a slab; one is
 * strained and pinned wherever it has a particle, so that it falls asleep with
 * energy, and another is thrown at it and wakes it; one is prescribed by two
 * corners.
 */
enum { ENSEMBLE_SLIDES, ENSEMBLE_RESTS, ENSEMBLE_THROWN, ENSEMBLE_PRESCRIBED };
enum {
    ENSEMBLE_CLOTHS = 4,
    ENSEMBLE_SIDE = 6,
    ENSEMBLE_COUNT = ENSEMBLE_SIDE * ENSEMBLE_SIDE,
    ENSEMBLE_NC = ENSEMBLE_CLOTHS * ENSEMBLE_COUNT,
    ENSEMBLE_BOX = 8, /* vertices of the slab, the first obstacle */
    ENSEMBLE_NV = ENSEMBLE_NC + 2 * ENSEMBLE_BOX, /* most of a scene */
    ENSEMBLE_STEPS = 64
};
/* A method of integration and a response: all pairs of them, but that an
 * explicit one, the last, has the one response. */
enum { ENSEMBLE_HOWS = 7 };

struct ensemble {
    struct slab d; /* with the definition */
    drape_cloth cloth[ENSEMBLE_CLOTHS];
    drape_pin pin[ENSEMBLE_COUNT], corner[2];
    double strained[ENSEMBLE_COUNT][3];
    double slides[ENSEMBLE_COUNT][3], falls[ENSEMBLE_COUNT][3];
};

/* Fills e, which must stay where it is while worlds are made of it. */
void ensemble_make(struct ensemble *e, int how);
/* The calls of live control before step k, 0 … ENSEMBLE_STEPS - 1. In most
 * steps there is none. Returns the first status that is no DRAPE_OK. */
int ensemble_call(drape_world *world, const struct ensemble *e, int k);
/* Whether two reports say the same, but for seconds and the number of boxes
 * that were made again (sleep.md §5). */
bool ensemble_same(drape_step_report a, drape_step_report b);

#endif
