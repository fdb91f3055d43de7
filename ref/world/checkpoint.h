/* SPDX-License-Identifier: Apache-2.0 */
/* Saving a world's state and loading it again. */
#ifndef REF_CHECKPOINT_H
#define REF_CHECKPOINT_H

#include "ref/world/state.h"

/* Of all that decides the bits of a definition. */
uint64_t checkpoint_fingerprint(const drape_def *def);
/* As drape_save and drape_load. */
int checkpoint_save(const struct world *w, drape_write *write, void *user);
int checkpoint_load(struct world *w, drape_read_bytes *read, void *user);

#endif
