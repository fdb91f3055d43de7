/* SPDX-License-Identifier: Apache-2.0 */
/* Checkpoints and logs in memory. */
#ifndef TESTS_RECALL_H
#define TESTS_RECALL_H

#include "tests/base/harness.h"

struct world;

/* A checkpoint or a log of a small scene. */
struct recall {
    size_t size, at;
    uint8_t data[1 << 18];
};

/* A writer that appends to a struct recall, and a reader of one from `at` on.
 */
drape_write recall_write;
drape_read_bytes recall_read;

bool recall_save(const drape_world *world, struct recall *r);
/* Loads r; returns drape_load's status. */
int recall_load(drape_world *world, struct recall *r);
/* The same of a world that was made without the public API. */
bool recall_save_inner(const struct world *world, struct recall *r);
int recall_load_inner(struct world *world, struct recall *r);
bool recall_same(const struct recall *a, const struct recall *b);

#endif
