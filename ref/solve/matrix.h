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

/* §3: the layout of the format for a grid of m × n particles. */
struct cdf ref_cdf(int32_t m, int32_t n);

/* Returns DRAPE_OK, or DRAPE_EARG if the counts are inconsistent. */
int ref_matrix(struct matrix *s);

/* Whether direction o, forward (sign 1) or backward (sign -1), leads from (i,
 * j) to a particle within the grid. */
static inline bool spring_inside(int32_t m, int32_t n, int32_t i, int32_t j,
                                 int o, int sign)
{
    int32_t a = i + sign * spring_di[o], b = j + sign * spring_dj[o];
    return a >= 0 && a < m && b >= 0 && b < n;
}

/* How much larger than p the index of the particle at the forward end of spring
 * o of p is. */
static inline int64_t spring_step(int32_t m, int o)
{
    return spring_di[o] + (int64_t)m * spring_dj[o];
}

#endif
