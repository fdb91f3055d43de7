/* SPDX-License-Identifier: Apache-2.0 */
/* The grids of multigrid, and the parts of a cycle on one of them.
 * spec/solve/multigrid.md §4 */
#ifndef REF_LEVEL_H
#define REF_LEVEL_H

#include "ref/solve/coarsest.h"
#include "ref/solve/multigrid.h"

/* One grid of the hierarchy and its streams. */
struct level {
    int32_t m, n;
    int64_t count;
    const uint8_t *fixed; /* NULL: all free */
    uint8_t *rule;        /* rules of interpolation from the next coarser
                             grid */
    sym *excess, *block;
    const sym *factor;
    const vec *b; /* right-hand side */
    vec *x, *y;   /* solution; product and residual */
};

/* §5: lays out the grids, from fine to coarse, in the streams of scratch.
 * Returns the number of grids. */
int multigrid_lay_out(const struct multigrid *s, struct level *l);
/* Grid k on the way down: it is smoothed from 0, and its residual is in y. */
void multigrid_descend(const struct multigrid *s, const struct level *l, int k);
/* The residual of grid k becomes the right-hand side of the next. */
void multigrid_restrict(const struct multigrid *s, const struct level *l,
                        int k);
/* Grid k on the way up: it gains the correction of the next, then it is
 * smoothed. */
void multigrid_prolong(const struct multigrid *s, const struct level *l, int k);
void multigrid_smooth(const struct multigrid *s, const struct level *l, int k);
/* §4: the part of F (b - A x) by which grid k is smoothed. */
real multigrid_damping(const struct multigrid *s, int k);
/* §5: the coarsest grid l. */
struct coarsest multigrid_coarsest(const struct multigrid *s,
                                   const struct level *l);

#endif
