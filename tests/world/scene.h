/* SPDX-License-Identifier: Apache-2.0 */
/* Whole scenes through the public API: small random ones, and audits. */
#ifndef TESTS_SCENE_H
#define TESTS_SCENE_H

#include "tests/base/harness.h"

/* Runs a small random scene for some steps. Each step ends without an
 * intersecting pair, or reports that it does not. Returns NULL, or the property
 * that fails. */
const char *scene_random(struct bytes *b);

/* Runs the same scene for a few steps on both backends. Returns NULL, or the
 * first difference; *steps: the number of steps compared. */
const char *scene_twins(struct bytes *b, int64_t *steps);

/* The same with a panel, alone or beside another panel or a rectangle, and an
 * implicit integrator. */
const char *scene_panels(struct bytes *b, int64_t *steps);

/* The same with seams, of random points. */
const char *scene_seams(struct bytes *b, int64_t *steps);

/* The number of intersecting pairs that involve cloth, by the exact audit. */
int64_t scene_audit(const drape_world *world, int n_cloths);

/* Whether a case is left out: the kernels of binary64 are compiled from the
 * same source as those of binary32, so one integrator is enough. */
static inline bool scene_left_out(int integrator, int backend)
{
    return REAL_BITS == 64 && backend == DRAPE_GPU && integrator != DRAPE_BW;
}

/* Of random scenes on both backends, one in so many is run, for the same
 * reason. */
enum { SCENE_EVERY = REAL_BITS == 64 ? 3 : 1 };

/* A hash of the whole state. */
uint64_t scene_hash(const drape_world *world);

#endif
