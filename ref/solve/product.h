/* SPDX-License-Identifier: Apache-2.0 */
/* Stage product: the system's matrix times a vector, from either form.
 * spec/solve/product.md */
#ifndef REF_PRODUCT_H
#define REF_PRODUCT_H

#include "ref/base/thin.h"
#include "ref/solve/matrix.h"

struct product {
    int32_t m, n;     /* particles along i and j */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg */
    int64_t n_blocks; /* SPRINGS·count: the compact form is used, or 0 */
    const sym *block; /* [n_blocks] kg, spring o of p at o·count + p */
    int64_t n_cdf;    /* ref_cdf(m, n).blocks where n_blocks is 0, else 0 */
    const mat *cdf;   /* [n_cdf] kg, from ref_matrix */
    const vec *x;     /* [count] */
    vec *y;           /* out: [count] A x */
};

/* Blocks between a particle and its neighbours in some forward directions. */
struct couplings {
    int32_t m, n;          /* particles along i and j */
    int64_t count;         /* m·n */
    int32_t directions;    /* forward: dj > 0, or dj = 0 and di > 0 */
    const int8_t *di, *dj; /* [directions] */
    const sym *block;      /* [directions·count] kg, o of p at o·count + p */
    const struct thin_parts *thin; /* likewise, in their place; or NULL */
    const vec *x;                  /* [count] */
    vec *y; /* in and out: [count] += the springs' part of A x */
};

/* §1: adds the springs' part of the product to y. */
void product_couplings(const struct couplings *c);

/* All of A x that is not a spring's. */
void product_start(const struct product *s);

/* DRAPE_OK. Both forms give the same bits. */
int ref_product(struct product *s);

#endif
