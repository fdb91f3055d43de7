/* SPDX-License-Identifier: Apache-2.0 */
/* Saves the state of a world as a checkpoint, and loads it again. */
#ifndef REF_CHECKPOINT_H
#define REF_CHECKPOINT_H

#include "ref/world/state.h"

/* Returns a hash of everything in a definition that can change the bits of a
 * result. print: [n_cloths + n_obstacles] hashes of its bodies, of which the
 * caller gives those that are not 0. */
uint64_t checkpoint_fingerprint(const drape_def *def, uint64_t *print);
/* Do what drape_save and drape_load say. */
int checkpoint_save(const struct world *w, drape_write *write, void *user);
int checkpoint_load(struct world *w, drape_read_bytes *read, void *user);

#endif
