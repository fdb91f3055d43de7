/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference over prescribed vertices and over displacements. The
 * device has the same in gpu/world/prescribed.cu. spec/world/step.md §1, §6, §7
 */
#ifndef REF_PRESCRIBED_H
#define REF_PRESCRIBED_H

#include "ref/base/stage.h"

/* Writes the place of each of n pins to its particle: to[pinned[k]] = x[k]. */
void prescribed_pin(int64_t n, const int32_t *pinned, const vec *x, vec *to);
/* Whether n vertices, or those that `at` names, have other bits in x0 than the
 * n of x1. */
bool prescribed_differs(int64_t n, const int32_t *at, const vec *x0,
                        const vec *x1);
/* A part of the straight way of n items to their targets. */
struct blend {
    int64_t n;
    const int32_t *at;    /* [n] the vertex of each item; NULL: the item */
    const vec *from, *to; /* m, by vertex */
    double part;          /* of the way, 0 … 1; 1: `to` itself */
    vec *x;               /* out: [n] m, by item */
};
void prescribed_blend(const struct blend *s);
/* Puts back old[i] into a[i] of n particles where they are fixed. */
void prescribed_keep(int64_t n, const uint8_t *fixed, const vec *old, vec *a);
/* Whether all n vectors are finite and within |a| ≤ 2^60. */
bool prescribed_sane(int64_t n, const vec *a);
/* Sets v [n] to the mean velocity (x1 - x0) / dt of n vertices. */
void prescribed_velocities(int64_t n, const vec *x0, const vec *x1, real dt,
                           vec *v);
/* Returns the square of the largest displacement of n vertices, m². */
real prescribed_furthest(int64_t n, const vec *x0, const vec *x1);

#endif
