/* SPDX-License-Identifier: Apache-2.0 */
/* Isolates the real roots of polynomials of degree at most 3 with Sturm chains,
 * and finds the sign of another polynomial at a root, exactly.
 * spec/narrow/narrow.md §6.2, §6.4 */
#ifndef REF_ROOTS_H
#define REF_ROOTS_H

#include "ref/narrow/point.h"

#define ROOT_UNKNOWN 2

/* The position of a point among a chain's roots: how many roots lie in (0,
 * point], and whether the point is a root. */
struct stand {
    int count;
    bool zero;
};

/* The sign changes of a polynomial f of degree at most 2, ordered among a
 * chain's roots (§6.4). */
struct variation_count {
    const struct poly *of;
    int sign;          /* sign of f at 0+ */
    int n;             /* distinct roots τ > 0 of f */
    bool twice;        /* f has a double root: no sign change */
    struct stand s[2]; /* [n] position of each root of f */
};

/* The Sturm chain of a polynomial p that has no repeated roots and no root at t
 * = 0 or t = 1. */
struct chain {
    struct poly p, d, r; /* p, its derivative, the negated remainder */
    int tail;            /* sign of the chain's last, constant member */
    int start;           /* sign variations at t = 0 */
    int roots;           /* roots in 0 < t < 1 */
    int seen;            /* entries of counts[] in use; there are at most 24
                            forms and box forms */
    struct variation_count counts[24];
};

/* Root i = 1, 2, … of a chain, counted from t = 0; or a time on the grid. */
struct root {
    const struct poly *of; /* NULL, or a polynomial known to be 0 there */
    struct chain *chain;
    int i;
    uint32_t cell; /* floor(2^30 t) */
    bool on_grid;  /* t = cell·2^-30 exactly */
    int octave; /* else, in the first or last cell: 2^octave ≤ τ ≤ 2^(octave
                   + 1) */
};

/* Makes chains whose roots are together the distinct roots of p ≢ 0 in 0 < t <
 * 1. Returns the number of chains, at most 2. */
int chains_make(struct big_arena *m, const struct poly *p, struct chain c[2]);
/* Locates root i of the chain, 1 ≤ i ≤ c->roots, to its cell. */
void root_locate(struct big_arena *m, struct chain *c, int i, struct root *r);
/* Returns the sign of f, of degree at most 2, at the root, or ROOT_UNKNOWN
 * where few words of f do not determine the sign. */
int root_quick(struct big_arena *m, const struct poly *f, const struct root *r);
/* A sufficient test: true only where f, of degree at most 2, is not 0 at the
 * root. */
bool root_avoids(struct big_arena *m, const struct poly *f,
                 const struct root *r);
/* Returns the exact sign of f, of degree at most 2, at the root. */
int root_sign(struct big_arena *m, const struct poly *f, const struct root *r);

#endif
