/* SPDX-License-Identifier: Apache-2.0 */
/* Exact orientation predicates. spec/narrow/audit.md §2 */
#ifndef REF_PREDICATES_H
#define REF_PREDICATES_H

#include "ref/base/real.h"

/* A point in binary64 in both builds, |p[k]| ≤ 2^60, subnormals included. */
typedef double point[3];

/* Returns the exact sign (-1, 0 or 1) of (b - a) × (c - a) · (d - a): 1 where d
 * lies on the side to which the normal of the triangle abc points. */
/*@ requires \forall integer k; 0 <= k < 3 ==>
  @     -0x1p60 <= a[k] <= 0x1p60 &&
  @     -0x1p60 <= b[k] <= 0x1p60 &&
  @     -0x1p60 <= c[k] <= 0x1p60 &&
  @     -0x1p60 <= d[k] <= 0x1p60; */
int ref_orient3(const point a, const point b, const point c, const point d);

/* Returns the exact orientation of a b c in the coordinates u and v: 1 is
 * counterclockwise. */
/*@ requires \forall integer k; 0 <= k < 3 ==>
  @     -0x1p60 <= a[k] <= 0x1p60 &&
  @     -0x1p60 <= b[k] <= 0x1p60 &&
  @     -0x1p60 <= c[k] <= 0x1p60;
  @ requires 0 <= u <= 2 && 0 <= v <= 2; */
int ref_orient2(const point a, const point b, const point c, int u, int v);

/* The same predicates in integers alone, without the filter, for tests. */
int ref_orient3_integer(const point a, const point b, const point c,
                        const point d);
int ref_orient2_integer(const point a, const point b, const point c, int u,
                        int v);

#endif
