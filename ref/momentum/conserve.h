/* SPDX-License-Identifier: Apache-2.0 */
/* Gives cloths in empty space the momentum back that a slice has lost, on
 * either backend. spec/momentum/momentum.md §3 */
#ifndef REF_CONSERVE_H
#define REF_CONSERVE_H

#include "ref/base/real.h"

struct tally;
struct world;

/* Its memory, taken when it is first needed. */
struct conserve {
    real *chunk;        /* in the memory of the backend */
    int32_t *label;     /* [n_cloths] likewise */
    int32_t *of;        /* [n_cloths] the same on the host */
    struct tally *part; /* [2·n_cloths] on the host: at the start, at the end */
    struct tally *island; /* [2·n_cloths] likewise, of islands */
};

/* Whether nothing but cloths and gravity acts on cloths. */
bool conserve_applies(const struct world *w);
/* §2: sets of [n_cloths] to the island of each cloth, which the contacts of the
 * slice join; one: all cloths are one. label: [n_cloths] scratch in the memory
 * of the backend. DRAPE_OK or negative. */
int conserve_find_islands(struct world *w, bool one, int32_t *label,
                          int32_t *of);
/* In such a scene changes the velocities v1 of a slice with this outcome.
 * DRAPE_OK or negative. */
int conserve_momentum(struct world *w, int outcome);

#endif
