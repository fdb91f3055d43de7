/* SPDX-License-Identifier: Apache-2.0 */
/* The multipliers that all contacts carry from slice to slice: of cloths that
 * are awake, and of those that are asleep. The host does this for both
 * backends, where somebody falls asleep or wakes, for checkpoints and where
 * bodies change. spec/contact/carry.md §3 */
#ifndef REF_KEPT_H
#define REF_KEPT_H

#include "ref/contact/carry.h"

struct edited;
struct world;

/* Brings all that is kept to the host, by key, into *list [*n] of the arena;
 * the caller gives it back. DRAPE_OK, DRAPE_ENOMEM or the backend's status. */
int kept_gather(const struct world *w, struct kept **list, int64_t *n);
/* Makes room for n entries and takes *part [n] of the arena; after it
 * kept_spread of n entries needs no memory. The entries kept so far stay. The
 * caller gives *part back. Likewise. */
int kept_room(struct world *w, int64_t n, struct kept **part);
/* Makes list [n], by key, all that is kept. part [n]: out, of kept_room.
 * Returns the backend's status. */
int kept_spread(struct world *w, const struct kept *list, int64_t n,
                struct kept *part);
/* Divides the entries anew between cloths that are awake and cloths that are
 * asleep. Likewise. */
int kept_divide(struct world *w);
/* Takes over the entries of the bodies that stay from the old world. Likewise.
 */
int kept_inherit(struct world *w, const struct edited *edited);
/* Whether an entry that was read names vertices of w and is a number. */
bool kept_good(const struct world *w, const struct kept *k);

#endif
