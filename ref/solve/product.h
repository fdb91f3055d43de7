/* SPDX-License-Identifier: Apache-2.0 */
/* Stage product: y = A x, with A in compact form or in compressed diagonal
 * format (cdf). spec/solve/product.md */
#ifndef REF_PRODUCT_H
#define REF_PRODUCT_H

#include "ref/base/packed.h"
#include "ref/solve/matrix.h"

struct product {
    int32_t m, n;     /* particles along i and j */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg */
    int64_t n_blocks; /* SPRINGS·count for the compact form, else 0 */
    const sym *block; /* [n_blocks] kg, spring o of p at o·count + p */
    int64_t n_cdf;    /* ref_cdf(m, n).blocks where n_blocks is 0, else 0 */
    const mat *cdf;   /* [n_cdf] kg, from ref_matrix */
    const vec *x;     /* [count] */
    vec *y;           /* out: [count] A x */
};

/* The blocks that couple particles to their neighbours in some forward
 * directions. */
struct couplings {
    int32_t m, n;          /* particles along i and j */
    int64_t count;         /* m·n */
    int32_t directions;    /* forward: dj > 0, or dj = 0 and di > 0 */
    const int8_t *di, *dj; /* [directions] */
    const sym *block;      /* [directions·count] kg, o of p at o·count + p */
    const struct packed_parts
        *packed;  /* the same, in place of block; or NULL */
    const vec *x; /* [count] */
    vec *y;       /* inout: [count] the springs' part of A x is added */
};

/* §1: adds the springs' part of the product to y. */
void product_couplings(const struct couplings *c);

/* Sets y to mass·x + extra·x, the part of A x that is not of springs. */
void product_start(const struct product *s);

/* Returns DRAPE_OK. Both forms of A give the same bits. */
int ref_product(struct product *s);

#endif
