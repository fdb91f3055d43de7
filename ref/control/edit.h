/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that are added and removed between two steps, for either backend: a
 * world with the new bodies is made, and it inherits the state of the old one.
 * spec/control/control.md §9 */
#ifndef REF_EDIT_H
#define REF_EDIT_H

#include "ref/world/state.h"

struct scene_edit;

/* Fills the definition of the edited world, and says where its bodies come
 * from. The arena, which must outlive both, owns what they point to, except
 * what the edit and the old world do. A cloth's particles start at 0, except
 * the pinned ones. DRAPE_OK or DRAPE_ENOMEM. */
int edit_define(const struct world *old, const struct scene_edit *edit,
                struct arena *arena, drape_def *def, struct edited *edited);
/* Gives a world that was made of that definition the state of the old one.
 * DRAPE_OK; DRAPE_ESTART and a text if the new body intersects something;
 * DRAPE_EDATA if its motion takes it beyond 2^60; DRAPE_ENOMEM, DRAPE_EDEVICE.
 */
int edit_inherit(struct world *w, const struct edited *edited,
                 drape_error *error);

#define EDIT_OPS(make)                                                         \
    {                                                                          \
        edit_define, make, edit_inherit                                        \
    }

#endif
