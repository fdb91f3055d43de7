/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 1 of the narrow phase: a floating-point filter with proven error bounds.
 * spec/narrow/narrow.md §4 */
#ifndef REF_FILTER_H
#define REF_FILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* The verdict of tier 1 or 2 on a pair. */
enum { FILTER_MISS, FILTER_HIT, FILTER_UNSURE };

/* A vector that is linear in t: its values at t = 0 and t = 1. */
struct linear {
    double at[2][3];
};

/* One pair in relative coordinates (§2). Each entry is one rounded difference
 * of two positions, m. */
struct motion {
    int count;            /* number of forms: 3 vertex-face, 4 edge-edge */
    struct linear f[3];   /* the vectors f g h */
    struct linear box[4]; /* the box forms */
};

/* The polynomials of §2 in Bernstein form on [0, 1]. */
struct forms {
    double v[4];       /* the cubic V */
    double q[4][3][3]; /* form j, axis k, coefficient i */
    double ev;         /* error bound of any value of V */
    double eq[3];      /* error bounds of forms, by axis */
    double eb[3];      /* error bounds of box forms, by axis */
};

/* Make the relative coordinates of a vertex and a face, or of two edges, from
 * positions x[t][vertex][axis]. */
/*@ requires \forall integer t, j, k; 0 <= t < 2 && 0 <= j < 4 && 0 <= k < 3 ==>
  @     -0x1.fffffffffffffp1023 <= x[t][j][k] <= 0x1.fffffffffffffp1023; */
void motion_vf(double x[2][4][3], struct motion *m);
/*@ requires \forall integer t, j, k; 0 <= t < 2 && 0 <= j < 4 && 0 <= k < 3 ==>
  @     -0x1.fffffffffffffp1023 <= x[t][j][k] <= 0x1.fffffffffffffp1023; */
void motion_ee(double x[2][4][3], struct motion *m);

/* Runs tier 1 (§4). Returns FILTER_MISS, or FILTER_UNSURE with s complete.
 * Where the inputs are beyond the range of the proof, the result is
 * FILTER_UNSURE, *inside is false and s must not be used. */
/*@ requires 3 <= m->count <= 4; */
int filter_signs(const struct motion *m, struct forms *s, bool *inside);

/* Maximum and minimum; both return b if a equals b. */
static inline double larger_of(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller_of(double a, double b)
{
    return a < b ? a : b;
}

/* Returns 1 or -1 where all n coefficients have that sign by more than the
 * error bound e, else 0. */
static inline int filter_sign(const double *c, int n, double e)
{
    double lo = c[0], hi = c[0];
    for (int i = 1; i < n; i++) {
        lo = smaller_of(lo, c[i]);
        hi = larger_of(hi, c[i]);
    }
    return lo > e ? 1 : hi < -e ? -1 : 0;
}

#endif
