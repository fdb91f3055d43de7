/* SPDX-License-Identifier: Apache-2.0 */
/* Big integers in a bounded arena: exact sums, differences and products.
 * spec/narrow/narrow.md §6.1 */
#ifndef REF_BIG_H
#define REF_BIG_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* An arena of words, handed out in order. The caller frees words by restoring
 * `used`. */
struct big_arena {
    uint32_t *word; /* [size] */
    int size, used;
    int most;  /* out: largest value of `used` */
    bool full; /* out: a number did not fit; results are void */
    int keep;  /* leading words that a struct approx keeps: ref/narrow/approx.h
                */
};

/* The integer sign · Σ d[i]·2^(32i). n = 0 exactly where sign = 0; otherwise
 * d[n-1] ≠ 0. */
struct big {
    uint32_t *d;
    int n, sign;
};

/* Returns the exponent of the lowest set bit of a finite x ≠ 0. */
int big_exponent(double x);
/* Returns x·2^-e. The caller chooses e so that the result is an integer. */
struct big big_make(struct big_arena *m, double x, int e);
/* Returns a as a big integer. */
struct big big_small(struct big_arena *m, uint32_t a);

struct big big_add(struct big_arena *m, struct big a, struct big b);
struct big big_sub(struct big_arena *m, struct big a, struct big b);
struct big big_mul(struct big_arena *m, struct big a, struct big b);
/* Returns a·b / 2^(32 from), truncated: products a.d[i]·b.d[j] with i + j <
 * from are left out, and where from > 0 some of those with i + j = from. The
 * magnitude may therefore be too small; approx_mul bounds the error. */
struct big big_mul_from(struct big_arena *m, struct big a, struct big b,
                        int from);
struct big big_times(struct big_arena *m, struct big a, uint32_t k);
struct big big_negate(struct big a);
/* Returns a·2^(32 k). */
struct big big_shift(struct big_arena *m, struct big a, int k);
/* Moves r down to `mark` and frees every other word taken since then. r must
 * have been made after the mark. */
struct big big_keep(struct big_arena *m, int mark, struct big r);
/* Returns a·b - c·d and frees all intermediate words. */
struct big big_det(struct big_arena *m, struct big a, struct big b,
                   struct big c, struct big d);

#endif
