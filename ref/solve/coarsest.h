/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid of multigrid, solved directly.
 * spec/solve/multigrid.md §5 */
#ifndef REF_COARSEST_H
#define REF_COARSEST_H

#include "ref/base/real.h"

/* It has at most so many particles: 48 unknowns. */
enum { COARSEST = 16, DENSE = 3 * COARSEST };

struct coarsest {
    int32_t m, n;      /* the grid */
    int64_t count;     /* m·n ≤ COARSEST */
    const sym *excess; /* [count] kg */
    const sym *block;  /* [STENCIL·count] kg */
    double *dense;     /* [DENSE·(DENSE + 1)] L below 1/D in the last row */
};

/* Fills dense with L and 1/D. */
void coarsest_factor(const struct coarsest *s);

/* z [count] = A⁻¹ b, 0 along what has no stiffness. */
void coarsest_solve(const struct coarsest *s, const vec *b, vec *z);

#endif
