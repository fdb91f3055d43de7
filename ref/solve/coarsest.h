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
    double *dense;     /* [DENSE·(DENSE + 1)] DENSE rows of L, a row of 1/D */
};

/* Fills dense with L and 1/D. */
void coarsest_factor(const struct coarsest *s);

/* Solves A z = b, z [count]. An unknown whose pivot was too small counts as
 * having 1/D = 0. */
void coarsest_solve(const struct coarsest *s, const vec *b, vec *z);

#endif
