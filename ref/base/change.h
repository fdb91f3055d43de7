/* SPDX-License-Identifier: Apache-2.0 */
/* What a caller changes of a world between two steps. The API takes these from
 * drape.h, and control applies them. spec/control/control.md */
#ifndef REF_CHANGE_H
#define REF_CHANGE_H

#include <stdint.h>

#include "spec/drape.h"

struct world;

/* Vectors that the caller gives: `here` in binary64 on the host, or else
 * `there` in the precision and the memory of the world. Both NULL: none. */
struct given {
    const double (*here)[3];
    const void *there;
};

/* A change of the bodies of a world: one of the first two, which is added, or
 * else the body to remove. */
struct scene_edit {
    const drape_cloth *cloth;
    const drape_obstacle *obstacle;
    int removed;
};

/* A world that takes the place of another one, whose bodies were changed. */
struct edited {
    const struct world *old;
    int32_t *from; /* [bodies] the body of the old world, -1: it is new */
    int added;     /* the new body, -1: none */
    int seams;
    int *seam; /* [seams] the seam of the old world */
};

#endif
