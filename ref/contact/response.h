/* SPDX-License-Identifier: Apache-2.0 */
/* Collision response of a step, from pairs to a state in which nothing
 * touches. spec/contact/response.md */
#ifndef REF_RESPONSE_H
#define REF_RESPONSE_H

#include "ref/contact/rounds.h"

/* Sets u and the counters for a step. DRAPE_EARG for a bad setting. */
int response_start(struct response *s);

/* Makes the active set of the pairs near at x0, by key. */
int response_find_close(struct response *s, const struct pairs *close);
/* Finds all pairs that touch between x0 and x1: hits; and those that arrive, if
 * pairs are looked for within reach, ≥ 0. */
int response_detect(struct response *s, real reach);
/* Hits, and arrivals that it does not have, join the active set. */
int response_join(struct response *s);

/* Repulsion and friction of the candidates at x0; u, v, x1 change. */
int response_repel(struct response *s, const struct pairs *close);

/* Impulses, zones and rollback until nothing touches; u, v, x1 change.
 * outcome has DRAPE_TRAPPED if something does all the same, and DRAPE_ZONES
 * where `brief` left it so. Ends always. */
int response_penetrate(struct response *s);

#endif
