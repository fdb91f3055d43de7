/* SPDX-License-Identifier: Apache-2.0 */
/* The true residual b - A x, for stage pcg. spec/solve/pcg.md §2 */
#ifndef REF_RESIDUAL_H
#define REF_RESIDUAL_H

#include "ref/solve/matrix.h"

struct residual {
    int32_t m, n;     /* particles along i and j */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg */
    const sym *block; /* [SPRINGS·count] kg, spring o of p at o·count + p */
    const uint8_t *fixed; /* [count] */
    const vec *b;         /* [count] */
    const vec *x, *low;   /* [count] the solution is x + low */
    vec *r;               /* out: [count] b - A (x + low), 0 where fixed */
};

void residual_find(const struct residual *s);

#endif
