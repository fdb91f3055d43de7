/* SPDX-License-Identifier: Apache-2.0 */
/* Real roots of small polynomials, exactly: spec/narrow/narrow.md §6.2 and
 * §6.4. */
#ifndef REF_ROOTS_H
#define REF_ROOTS_H

#include "ref/narrow/point.h"

#define ROOT_UNKNOWN 2

/* How many roots of a chain lie in (0, point], and whether the point is one. */
struct stand {
    int count;
    bool zero;
};

/* Where a polynomial of degree at most 2 has its roots among a chain's. */
struct turns {
    const struct poly *of;
    int sign;          /* at 0+ */
    int n;             /* distinct roots τ > 0 */
    bool twice;        /* a double root: the sign stays */
    struct stand s[2]; /* [n], of each root */
};

/* A Sturm chain of a polynomial without repeated roots, without roots at
 * t = 0 and 1. */
struct chain {
    struct poly p, d, r; /* p, its derivative, the negated remainder */
    int tail;            /* sign of the constant that ends the chain */
    int start;           /* sign variations at t = 0 */
    int roots;           /* in 0 < t < 1 */
    int seen;            /* of the polynomials asked for: forms, box forms */
    struct turns turns[24];
};

/* Root i = 1, 2, … of a chain from t = 0 on, or a grid time. */
struct root {
    const struct poly *of; /* NULL or a polynomial that is 0 there */
    struct chain *chain;
    int i;
    uint32_t cell; /* floor(2^30 t) */
    bool on_grid;  /* t = cell·2^-30 */
    int octave; /* else, in an end cell: 2^octave ≤ τ ≤ 2^(octave + 1) */
};

/* Chains whose roots together are the roots of p ≢ 0 in 0 < t < 1, repeated
 * ones once; returns how many chains, at most 2. */
int chains_make(struct room *m, const struct poly *p, struct chain c[2]);
/* Root i of the chain, 1 ≤ i ≤ c->roots. */
void root_locate(struct room *m, struct chain *c, int i, struct root *r);
/* The sign of f, of degree at most 2, at the root, or ROOT_UNKNOWN where few
 * words of f do not tell. */
int root_quick(struct room *m, const struct poly *f, const struct root *r);
/* True only where f, of degree at most 2, is not 0 at the root. */
bool root_avoids(struct room *m, const struct poly *f, const struct root *r);
/* The sign of f, of degree at most 2, at the root. */
int root_sign(struct room *m, const struct poly *f, const struct root *r);

#endif
