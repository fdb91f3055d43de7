/* SPDX-License-Identifier: Apache-2.0 */
/* Stages sum and dot, and the order of additions that all sums of drape have.
 * spec/base/sum.md */
#ifndef REF_SUM_H
#define REF_SUM_H

#include "ref/base/stage.h"

enum { SUM_CHUNK = 256 };

/* Returns the number of chunks of n items. The sum of the items needs as many
 * reals of scratch. */
static inline int64_t sum_chunks(int64_t n)
{
    return (n + SUM_CHUNK - 1) / SUM_CHUNK;
}

/* §2: returns the sum of one chunk by halving strides. Overwrites s. */
static inline real sum_tree(real s[SUM_CHUNK])
{
    for (int h = SUM_CHUNK / 2; h > 0; h /= 2)
        for (int i = 0; i < h; i++)
            s[i] += s[i + h];
    return s[0];
}

/* §3: returns the sum of n chunk sums; 0 if n is 0. Overwrites chunk. A stage
 * that computes the items of its sum calls sum_tree for each chunk, then this.
 */
real ref_sum_finish(int64_t n, real *chunk);

struct sum {
    int64_t n;        /* items */
    const real *a;    /* [n] */
    int64_t n_chunks; /* sum_chunks(n) */
    real *chunk;      /* scratch: [n_chunks] */
    real value;       /* out: the sum */
};

struct dot {
    int64_t n;        /* items */
    const vec *a, *b; /* [n] */
    int64_t n_chunks; /* sum_chunks(n) */
    real *chunk;      /* scratch: [n_chunks] */
    real value;       /* out: the sum of vec_dot(a[k], b[k]) */
    int64_t n_w;      /* n, or 0: all weights are 1 */
    const real *w;    /* [n_w] weights of the items */
};

/* Both return DRAPE_OK. A NaN or an overflow appears in the value. */
int ref_sum(struct sum *s);
int ref_dot(struct dot *s);

#endif
