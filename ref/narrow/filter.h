/* SPDX-License-Identifier: Apache-2.0 */
/* The first tier of the narrow phase: spec/narrow/narrow.md §4. */
#ifndef REF_FILTER_H
#define REF_FILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* How a filter ended. */
enum { FILTER_MISS, FILTER_HIT, FILTER_UNSURE };

/* A vector linear in t: its values at t = 0 and t = 1. */
struct linear {
    double at[2][3];
};

/* One pair in relative coordinates (§2). Each entry is
 * one rounded difference of two positions. */
struct motion {
    int count;            /* of forms: 3 vertex-face, 4 edge-edge */
    struct linear f[3];   /* the vectors f g h */
    struct linear box[4]; /* the box forms */
};

/* The polynomials of §2 in Bernstein form on [0, 1]. */
struct forms {
    double v[4];       /* the cubic V */
    double q[4][3][3]; /* form j, axis k, coefficient i */
    double ev;         /* error of any value of V */
    double eq[3];      /* of any value of a form, by axis */
    double eb[3];      /* of any value of a box form, by axis */
};

/* Positions x[t][vertex][axis] to a motion. */
void motion_vf(double x[2][4][3], struct motion *m);
void motion_ee(double x[2][4][3], struct motion *m);

/* First tier (§4): FILTER_MISS or FILTER_UNSURE; s is then complete. Where
 * the proof's range is left, *inside is false and s is not to be used. */
int filter_signs(const struct motion *m, struct forms *s, bool *inside);

/* The larger and the smaller of two, the second of equals. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* 1 or -1 where all n coefficients have that sign beyond error e, else 0. */
static inline int filter_sign(const double *c, int n, double e)
{
    double lo = c[0], hi = c[0];
    for (int i = 1; i < n; i++) {
        lo = smaller(lo, c[i]);
        hi = larger(hi, c[i]);
    }
    return lo > e ? 1 : hi < -e ? -1 : 0;
}

#endif
