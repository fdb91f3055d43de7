/* SPDX-License-Identifier: Apache-2.0 */
/* Cloths at rest fall asleep by islands, and wake where something comes near.
 * spec/sleep/sleep.md */
#ifndef REF_SLEEP_H
#define REF_SLEEP_H

#include "ref/sleep/rest.h"

enum { SLEEP_STEPS = 30, SLEEP_MOST = 1 << 20 };

/* Takes the arrays that lie on the host. DRAPE_OK or DRAPE_ENOMEM. */
int sleep_make(struct world *w);
/* Gives the particles of cloth k the weights that they have when awake. */
void sleep_weigh(struct world *w, int k);
/* Wakes all. */
void sleep_wake(struct world *w);
/* The streams and energies hold another state than they did. */
void sleep_forget(struct world *w);
/* Keeps who is asleep when a step begins, and brings that back. */
void sleep_note(struct world *w);
void sleep_undo(struct world *w);
/* Begins a step: holds the cloths that are asleep, and no others. */
int sleep_hold(struct world *w);
/* Begins a slice, after obstacles and pins have moved. */
int sleep_begin_slice(struct world *w);
/* After a query of the broad phase: sets `woken` where a pair of it has a body
 * that moves and a cloth that is asleep. */
int sleep_notice(struct world *w);
/* Wakes the cloths that were woken, with those that fell asleep with them. */
int sleep_wake_disturbed(struct world *w);
/* Ends a slice: counts steps at rest, and lets islands fall asleep. */
void sleep_count(struct world *w, int outcome);
/* The energies of cloth k that is held, [3] J; NULL: it is not. */
const double *sleep_energy(const struct world *w, int k);
/* Calls work for each run of neighbouring cloths that are awake, with its first
 * particle and how many it has. */
void sleep_runs(struct world *w,
                void (*work)(struct world *w, int64_t first, int64_t n));
/* Zeroes the items, of so many bytes, of particles that are asleep; a: [nc], or
 * NULL. */
void sleep_clear(struct world *w, void *a, size_t size);

#endif
