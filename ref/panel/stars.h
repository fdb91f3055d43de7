/* SPDX-License-Identifier: Apache-2.0 */
/* Stars: second differences about a particle from which a neighbour is missing
 * or moved. spec/panel/panel.md §4 */
#ifndef REF_STARS_H
#define REF_STARS_H

#include "ref/base/arena.h"
#include "ref/panel/lists.h"

/* What stars are made of. */
struct star_grid {
    const drape_cloth *def;
    const struct cloth *cloth;
    const double *area; /* [count] m², of a particle that has odd cells; 0 of
                           all others */
    const uint8_t *hinged; /* [count] 1: what the particle lacks a hinge has,
                              seam.md §6.3; NULL: none has */
    struct arena *arena;
};

/* Takes the stars of a panel from the arena, but their stiffness: star, share,
 * star_way and n_stars of `to`. DRAPE_OK or DRAPE_ENOMEM. */
int make_stars(const struct star_grid *s, struct panel *to);

#endif
