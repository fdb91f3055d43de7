/* SPDX-License-Identifier: Apache-2.0 */
/* Whole numbers of many words in a bounded room: spec/narrow/narrow.md §6.1. */
#ifndef REF_BIG_H
#define REF_BIG_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* Words handed out in order; the caller gives back by restoring `used`. */
struct room {
    uint32_t *word; /* [size] */
    int size, used;
    int most;  /* out: the largest `used` */
    bool full; /* out: a number did not fit: results are void */
    int keep;  /* leading words that a near number keeps: ref/narrow/near.h */
};

/* sign · Σ d[i]·2^(32i); n = 0 exactly where sign = 0, else d[n-1] ≠ 0. */
struct big {
    uint32_t *d;
    int n, sign;
};

/* The exponent of the lowest set bit of a finite x ≠ 0. */
int big_exponent(double x);
/* x·2^-e, whole by the choice of e. */
struct big big_make(struct room *m, double x, int e);
/* A number below 2^32. */
struct big big_small(struct room *m, uint32_t a);

struct big big_add(struct room *m, struct big a, struct big b);
struct big big_sub(struct room *m, struct big a, struct big b);
struct big big_mul(struct room *m, struct big a, struct big b);
/* a·b over 2^(32 from), of which products of words below that are left out,
 * and, where from > 0, some of the last word's. */
struct big big_mul_from(struct room *m, struct big a, struct big b, int from);
struct big big_times(struct room *m, struct big a, uint32_t k);
struct big big_negate(struct big a);
/* a·2^(32 k). */
struct big big_shift(struct room *m, struct big a, int k);
/* r, made since the mark, moved down to it; all else since is given back. */
struct big big_keep(struct room *m, int mark, struct big r);
/* a·b - c·d, leaving nothing else in the room. */
struct big big_det(struct room *m, struct big a, struct big b, struct big c,
                   struct big d);

#endif
