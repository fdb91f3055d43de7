/* SPDX-License-Identifier: Apache-2.0 */
/* Stage matrix: the implicit system of one cloth in the paper's compressed
 * diagonal format, and its diagonal. spec/solve/matrix.md */
#ifndef REF_MATRIX_H
#define REF_MATRIX_H

#include "ref/cloth/cloth.h"

/* The main diagonal, then for each spring direction the forward and the
 * backward diagonal. */
enum { DIAGONALS = 1 + 2 * SPRINGS };

/* Rows of a 3 × 3 block. */
typedef struct mat {
    vec x, y, z;
} mat;

/* §3: where the blocks of each diagonal are stored. */
struct cdf {
    int64_t offset[DIAGONALS]; /* column minus row */
    int64_t start[DIAGONALS];  /* row p of diagonal k is at start[k] + p */
    int64_t blocks;            /* of all diagonals */
};

struct matrix {
    int32_t m, n;     /* particles along i and j, ≥ 1 */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg, scaled as the integrator wants it */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg, added to the diagonal */
    int64_t n_blocks; /* SPRINGS·count */
    const sym *block; /* [n_blocks] kg, spring o of p at o·count + p */
    int64_t n_cdf;    /* ref_cdf(m, n).blocks, or 0: the diagonal only */
    sym *diagonal;    /* out: [count] */
    mat *cdf;         /* out: [n_cdf] */
};

/* §3: returns the layout of the format for a grid of m × n particles. */
struct cdf ref_cdf(int32_t m, int32_t n);

/* Returns DRAPE_OK, or DRAPE_EARG if the counts are inconsistent. */
int ref_matrix(struct matrix *s);

#endif
