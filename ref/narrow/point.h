/* SPDX-License-Identifier: Apache-2.0 */
/* Signs of small polynomials at a point, exactly: spec/narrow/narrow.md §6.3.
 */
#ifndef REF_POINT_H
#define REF_POINT_H

#include "ref/narrow/big.h"

#define ROOT_GRID 30 /* roots are located to 2^-30 in t */
#define ROOT_ONE (UINT32_C(1) << ROOT_GRID)

/* Σ c[i]·τ^i with τ = t/(1-t): the scaled Bernstein form on t in [0, 1].
 * Leading coefficients may be zero: that is a root at t = 1. */
struct poly {
    int degree; /* at most 3 */
    struct big c[4];
};

/* A time τ > 0 (or 0 or ∞ on the grid): a/b·2^(32 k), b ≥ 0; or both roots of
 * a quadratic q. */
struct point {
    const struct poly *q; /* or NULL */
    struct big a, b;
    int k;
};

/* Whether all coefficients are zero. */
bool poly_zero(const struct poly *p);
/* True only where p and f, of degree at most 2, have no root in common: their
 * resultant as quadratics is not 0, by its rest modulo a prime. */
bool poly_coprime(const struct poly *p, const struct poly *f);
/* The time g·2^-30, g ≤ 2^30. */
struct point point_grid(struct room *m, uint32_t g);
/* τ = 2^e. */
struct point point_power(struct room *m, int e);
/* The sign of f at the point: at the smaller root of q, at the larger. */
void point_sign(struct room *m, const struct poly *f, const struct point *p,
                int sign[2]);
/* The sign of f, of degree 1 or 2, inside the open cell (g, g + 1)·2^-30, where
 * its Bernstein form there, of few words, tells: else 2. */
int poly_sign_cell(struct room *m, const struct poly *f, uint32_t g);
/* The same for 2^e ≤ τ ≤ 2^(e + 1). */
int poly_sign_octave(struct room *m, const struct poly *f, int e);
/* The sign of b² - 4ac of c + bτ + aτ². */
int poly_discriminant(struct room *m, const struct big c[3]);

#endif
