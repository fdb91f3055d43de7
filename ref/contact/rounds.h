/* SPDX-License-Identifier: Apache-2.0 */
/* What a round of collision response computes between its stages, by the
 * reference. spec/contact/response.md */
#ifndef REF_ROUNDS_H
#define REF_ROUNDS_H

#include "ref/contact/response.h"

/* §1: writes u, the mean velocity. */
void rounds_start(struct response *s);

/* §1: ends of the step for those of n vertices whose mean velocity changed;
 * moved: NULL, all of them. stop: v becomes u, too. */
void rounds_advance(struct response *s, int64_t n, const int32_t *vertex,
                    const uint8_t *moved, bool stop);

/* §3: touched is set for the free vertices of the hits. */
void rounds_touch(const struct response *s);

/* §4: caps the targets of the active contacts at the impact margin. */
void rounds_settle(const struct response *s, struct contact *contact);

#endif
