/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that are added and removed between two steps, for either backend: a
 * world with the new bodies is made, and it inherits the state of the old one.
 * spec/control/control.md §9 */
#ifndef REF_HEIR_H
#define REF_HEIR_H

#include "ref/world/state.h"

struct edit;

/* Fills the definition of the heir, and says where its bodies come from. The
 * arena, which must outlive both, owns what they point to, except what the edit
 * and the old world do. A cloth's particles start at 0, except the pinned ones.
 * DRAPE_OK or DRAPE_ENOMEM. */
int heir_define(const struct world *old, const struct edit *edit,
                struct arena *arena, drape_def *def, struct heir *heir);
/* Gives the cloths that stay the sizes by which the old world's tree was made.
 */
void heir_sizes(struct world *w, const struct heir *heir);
/* Gives a world that was made of that definition the state of the old one.
 * DRAPE_OK; DRAPE_ESTART and a text if the new body intersects something;
 * DRAPE_EDATA if its motion leads beyond 2^60; DRAPE_ENOMEM, DRAPE_EDEVICE. */
int heir_inherit(struct world *w, const struct heir *heir, drape_error *error);

#define HEIR_OPS(make)                                                         \
    {                                                                          \
        heir_define, make, heir_inherit                                        \
    }

#endif
