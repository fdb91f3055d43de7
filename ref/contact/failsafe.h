/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of collision response. spec/contact/response.md */
#ifndef REF_FAILSAFE_H
#define REF_FAILSAFE_H

#include "ref/contact/response.h"

/* What a pool must hold. */
struct room {
    struct pool *pool;
    int64_t need;
    size_t size; /* bytes of an item */
};

/* Makes the n pools hold what they must. DRAPE_OK or grow's error. */
int response_grow(struct response *s, int n, const struct room *room);

/* §1: ends of the step for those of n vertices whose mean velocity changed;
 * moved: NULL, all of them. */
void response_advance(struct response *s, int64_t n, const int32_t *vertex,
                      const uint8_t *moved);

/* §5: the vertices of all hits since impulses ended move in zones. */
int response_stiffen(struct response *s);

/* §6: the vertices of the hits go back; hits is how many did. */
int response_roll(struct response *s, int round);

#endif
