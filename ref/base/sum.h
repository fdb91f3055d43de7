/* SPDX-License-Identifier: Apache-2.0 */
/* Stages sum and dot, and the one order of every sum. spec/base/sum.md */
#ifndef REF_SUM_H
#define REF_SUM_H

#include "ref/base/stage.h"

enum { SUM_CHUNK = 256 };

/* Chunks of n items: the reals of scratch that their sum needs. */
static inline int64_t sum_chunks(int64_t n)
{
    return (n + SUM_CHUNK - 1) / SUM_CHUNK;
}

/* §2: the sum of one chunk, halving strides; s is used up. */
static inline real sum_tree(real s[SUM_CHUNK])
{
    for (int h = SUM_CHUNK / 2; h > 0; h /= 2)
        for (int i = 0; i < h; i++)
            s[i] += s[i + h];
    return s[0];
}

/* §3: the sum of n chunk sums, which are used up; 0 where n is 0. A stage
 * that sums what it computes fills its chunks with sum_tree and ends here. */
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
};

/* Both: DRAPE_OK. A NaN or an overflow shows in the value. */
int ref_sum(struct sum *s);
int ref_dot(struct dot *s);

#endif
