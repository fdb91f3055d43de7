/* SPDX-License-Identifier: Apache-2.0 */
/* Exact signs of polynomials of degree at most 3 at a rational point, or at the
 * roots of a quadratic. spec/narrow/narrow.md §6.3 */
#ifndef REF_POINT_H
#define REF_POINT_H

#include "ref/narrow/big.h"

#define ROOT_GRID 30 /* roots are located to 2^-30 in t */
#define ROOT_ONE (UINT32_C(1) << ROOT_GRID)

/* The polynomial Σ c[i]·τ^i with τ = t/(1-t), which is the scaled Bernstein
 * form on t in [0, 1]. Leading coefficients may be zero: each of them is a root
 * at t = 1. */
struct poly {
    int degree; /* at most 3 */
    struct big c[4];
};

/* A time τ = a/b·2^(32 k) with a, b ≥ 0, where τ may be 0 or infinite only on
 * the grid; or both roots of a quadratic q. */
struct point {
    const struct poly *q; /* or NULL */
    struct big a, b;
    int k;
};

/* Whether all coefficients are zero. */
bool poly_zero(const struct poly *p);
/* A sufficient test: true only where p and f, of degree at most 2, have no
 * common root. Their resultant as quadratics is then nonzero modulo
 * APPROX_PRIME. */
bool poly_coprime(const struct poly *p, const struct poly *f);
/* Returns the time t = g·2^-30, g ≤ 2^30. */
struct point point_grid(struct big_arena *m, uint32_t g);
/* Returns the time τ = 2^e. */
struct point point_power(struct big_arena *m, int e);
/* Finds the sign of f at the point, in sign[0]. With a quadratic p->q, sign[0]
 * is at its smaller root and sign[1] at its larger root. */
void point_sign(struct big_arena *m, const struct poly *f,
                const struct point *p, int sign[2]);
/* Returns the sign of f, of degree 1 or 2, in the open cell (g, g + 1)·2^-30 if
 * few words of its Bernstein form there determine the sign, else 2. */
int poly_sign_cell(struct big_arena *m, const struct poly *f, uint32_t g);
/* As poly_sign_cell, for the interval 2^e ≤ τ ≤ 2^(e + 1). */
int poly_sign_octave(struct big_arena *m, const struct poly *f, int e);
/* Returns the sign of b² - 4ac for c + bτ + aτ². */
int poly_discriminant(struct big_arena *m, const struct big c[3]);

#endif
