/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid of multigrid, solved directly.
 * spec/solve/multigrid.md §5 */
#ifndef REF_COARSEST_H
#define REF_COARSEST_H

#include "ref/base/real.h"

/* Particles and unknowns of the coarsest grid, at most. */
enum { COARSEST = 16, DENSE = 3 * COARSEST };

struct coarsest {
    int32_t m, n;      /* particles along i and j */
    int64_t count;     /* m·n ≤ COARSEST */
    const sym *excess; /* [count] kg */
    const sym *block;  /* [STENCIL·count] kg */
    double *dense;     /* [DENSE·DENSE] rows of the inverse */
};

/* Fills dense with A, in rows of DENSE. */
void coarsest_fill(const struct coarsest *l);

/* Fills the rows of A's unknowns in dense with the inverse of A. An unknown
 * whose pivot is too small has zeros in its row and column. */
void coarsest_invert(const struct coarsest *s);

/* z = A⁻¹ b, z [count]. */
void coarsest_solve(const struct coarsest *s, const vec *b, vec *z);

#endif
