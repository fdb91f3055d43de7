/* SPDX-License-Identifier: Apache-2.0 */
/* Decides exactly whether two triangles intersect. spec/narrow/audit.md §3 */
#ifndef REF_TRITRI_H
#define REF_TRITRI_H

#include "ref/narrow/predicates.h"

/* A triangle of a mesh: its vertex numbers and their positions. */
struct face {
    int32_t v[3];
    point p[3]; /* m, |p| ≤ 2^60 */
};

/* The rounded plane of a triangle, for filters: a corner o, a normal n, and for
 * each component of n the sum of the magnitudes of its two products. */
struct plane {
    point o, n, size;
};

/*@ requires \forall integer j; 0 <= j < 3 ==> 0 <= t->v[j];
  @ requires \forall integer j, k; 0 <= j < 3 && 0 <= k < 3 ==>
  @     -0x1p60 <= t->p[j][k] <= 0x1p60; */
struct plane ref_plane(const struct face *t);

/* True where the three corners lie on one line. */
bool ref_collinear(const struct face *t);

/* True where t and s have a common point beyond the vertices and edges that
 * they share (§1.2). of_t is ref_plane(t). Neither triangle may be
 * degenerate. */
/*@ requires \forall integer j; 0 <= j < 3 ==> 0 <= t->v[j];
  @ requires \forall integer j, k; 0 <= j < 3 && 0 <= k < 3 ==>
  @     -0x1p60 <= t->p[j][k] <= 0x1p60;
  @ requires \forall integer j; 0 <= j < 3 ==> 0 <= s->v[j];
  @ requires \forall integer j, k; 0 <= j < 3 && 0 <= k < 3 ==>
  @     -0x1p60 <= s->p[j][k] <= 0x1p60; */
bool ref_tritri(const struct face *t, const struct plane *of_t,
                const struct face *s);

#endif
