/* SPDX-License-Identifier: Apache-2.0 */
/* Signs of small polynomials at a point, exactly: spec/30_narrow.md §6.3. */
#ifndef REF_POINT_H
#define REF_POINT_H

#include "ref/big.h"

#define ROOT_GRID 30 /* roots are located to 2^-30 in t */
#define ROOT_ONE (UINT32_C(1) << ROOT_GRID)

/* Σ c[i]·τ^i with τ = t/(1-t): the scaled Bernstein form on t in [0, 1].
 * Leading coefficients may be zero: that is a root at t = 1. */
struct poly {
    int degree; /* at most 3 */
    struct big c[4];
};

/* A time τ > 0 (or 0 or ∞ on the grid): a/b, or a root of a quadratic. */
struct point {
    const struct poly *q; /* NULL: τ = a/b, b ≥ 0 */
    int which;            /* 0 the smaller, 1 the larger root of q */
    struct big a, b;
};

/* Whether all coefficients are zero. */
bool poly_zero(const struct poly *p);
/* The time g·2^-30, g ≤ 2^30. */
struct point point_grid(struct room *m, uint32_t g);
/* The sign of f at the point. */
int point_sign(struct room *m, const struct poly *f, const struct point *p);
/* The sign of b² - 4ac of c + bτ + aτ². */
int poly_discriminant(struct room *m, const struct big c[3]);

#endif
