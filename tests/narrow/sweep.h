/* SPDX-License-Identifier: Apache-2.0 */
/* Finds all candidate pairs of the public frames by a sweep over swept boxes.
 * The code is independent of ref/broad/. */
#ifndef TESTS_SWEEP_H
#define TESTS_SWEEP_H

#include "tests/narrow/ply.h"

/* A mesh before and after a step. Only pairs are reported whose second box
 * begins, on x, in [from, to). */
struct frames {
    struct ply at[2];
    real from, to;
};

/* Reads a scene; returns false where it cannot be read. frames_free must be
 * called in either case. */
bool frames_read(const char *name, struct frames *f);
void frames_free(struct frames *f);

/* Restricts the pairs to a slab that begins at the mean and has 1/parts of the
 * range beyond; parts = 0 means all pairs. */
void frames_slab(struct frames *f, int parts);

/* Calls pair(user, kind, vertices) for each vertex and face and each two edges
 * whose swept boxes overlap and which share no vertex. Returns false without
 * memory. */
bool frames_sweep(const struct frames *f,
                  void (*pair)(void *user, int kind, const int32_t v[4]),
                  void *user);

/* Calls pair(…) for each line of the scene's hits.txt, in the slab or not.
 * Returns the number of lines in the slab; *lines is the number of all lines, 0
 * if the file is missing. */
int64_t frames_hits(const struct frames *s, const char *name,
                    void (*pair)(void *user, int kind, const int32_t v[4]),
                    void *user, int64_t *lines);

#endif
