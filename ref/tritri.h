/* SPDX-License-Identifier: Apache-2.0 */
/* Whether two triangles intersect, exactly. spec/40_audit.md §3 */
#ifndef REF_TRITRI_H
#define REF_TRITRI_H

#include "ref/predicates.h"

/* True where the three points of a triangle lie on one line. */
bool ref_collinear(const point t[3]);

/* Moves the corners that t and s share to the front of both, in one order,
 * and returns how many they are; each triangle has three different ones. */
int ref_align(int32_t t[3], int32_t s[3]);

/* True where triangles t and s, neither collinear, have a common point beyond
 * what they share: `shared` of their corners are one vertex, and these come
 * first in both and in the same order. */
bool ref_tritri(const point t[3], const point s[3], int shared);

#endif
