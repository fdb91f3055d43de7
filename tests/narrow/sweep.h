/* SPDX-License-Identifier: Apache-2.0 */
/* All candidate pairs of the shared frames, by a sweep of swept boxes that
 * shares nothing with ref/broad/broad.c. */
#ifndef TESTS_SWEEP_H
#define TESTS_SWEEP_H

#include "tests/base/names.h"
/* its names need those */
#include "tests/narrow/ply.h"

/* A mesh before and after a step, and which pairs are asked for: those whose
 * second box, by x, begins in [from, to). */
struct frames {
    struct ply at[2];
    real from, to;
};

/* False where the scene cannot be read. frames_free in any case. */
bool frames_read(const char *name, struct frames *f);
void frames_free(struct frames *f);

/* From the mean on, a part of what lies beyond it; all for no part. */
void frames_slab(struct frames *f, int parts);

/* Calls pair(user, kind, vertices) for each vertex and face and each two edges
 * without a common vertex whose swept boxes overlap; false: no memory. */
bool frames_sweep(const struct frames *f,
                  void (*pair)(void *user, int kind, const int32_t v[4]),
                  void *user);

/* The same for each line of the scene's hits.txt, wherever it lies; returns how
 * many lie in the slab, *lines: how many there are, 0 if they are not there. */
int64_t frames_hits(const struct frames *s, const char *name,
                    void (*pair)(void *user, int kind, const int32_t v[4]),
                    void *user, int64_t *lines);

#endif
