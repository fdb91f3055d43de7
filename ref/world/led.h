/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over what is led, and over the ways of vertices, by the reference.
 * spec/world/step.md §1, §6, §7 */
#ifndef REF_LED_H
#define REF_LED_H

#include "ref/world/state.h"

/* Writes where the particle of each of n pins ends: to[pinned[k]] = x[k]. */
void led_pin(int64_t n, const int32_t *pinned, const vec *x, vec *to);
/* Whether an obstacle or a pin is elsewhere in x1 than in x0. */
bool led_moves(const struct world *w);
/* v [n]: the mean velocity of n vertices. */
void led_velocities(int64_t n, const vec *x0, const vec *x1, real dt, vec *v);
/* The square of the longest way of n vertices, m². */
real led_furthest(int64_t n, const vec *x0, const vec *x1);

#endif
