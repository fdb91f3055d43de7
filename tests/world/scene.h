/* SPDX-License-Identifier: Apache-2.0 */
/* Whole scenes through the public API: small random ones, and audits. */
#ifndef TESTS_SCENE_H
#define TESTS_SCENE_H

#include "tests/base/harness.h"

/* A small random scene runs some steps: NULL, or what does not hold. Every
 * step that does not say otherwise ends without an intersecting pair. */
const char *scene_random(struct bytes *b);

/* The same scene for a few steps on both backends: NULL, or what differs
 * first; *steps: how many were compared. */
const char *scene_twins(struct bytes *b, int64_t *steps);

/* Intersecting pairs that involve cloth, by the exact audit. */
int64_t scene_audit(const drape_world *world, int n_cloths);

/* Hash of the whole state. */
uint64_t scene_hash(const drape_world *world);

#endif
