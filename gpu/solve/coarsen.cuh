/* SPDX-License-Identifier: Apache-2.0 */
/* How grids interpolate from coarser ones. spec/solve/multigrid.md §2 */
#ifndef GPU_COARSEN_CUH
#define GPU_COARSEN_CUH

#include "gpu/solve/grid.cuh"

/* Twice the weight along an axis of the coarse particle d steps before: left
 * and right say whether a particle between two takes only that one. */
static __device__ inline int axis_part(int d, bool left, bool right)
{
    if (d == 1)
        return right ? 0 : left ? 2 : 1;
    if (d == -1)
        return left ? 0 : right ? 2 : 1;
    return d == 0 ? 2 : 0;
}

/* Four times the weight of the coarse particle (di, dj) steps before. */
static __device__ inline int part_of(int rule, int di, int dj)
{
    return axis_part(di, rule & ONLY_LEFT, rule & ONLY_RIGHT) *
           axis_part(dj, rule & ONLY_DOWN, rule & ONLY_UP);
}

static __device__ inline bool tied(sym b)
{
    return b.xx != 0 || b.yy != 0 || b.zz != 0;
}

/* The rule of a particle from the blocks to the right and up of all. */
static __device__ inline uint8_t rule_at(struct grid g, struct place at,
                                         const sym *right, const sym *up)
{
    int rule = 0;
    if (at.i % 2 && at.i + 1 < g.m) {
        bool before = tied(right[at.p - 1]), after = tied(right[at.p]);
        if (before != after)
            rule |= after ? ONLY_RIGHT : ONLY_LEFT;
    }
    if (at.j % 2 && at.j + 1 < g.n) {
        bool before = tied(up[at.p - g.m]), after = tied(up[at.p]);
        if (before != after)
            rule |= after ? ONLY_UP : ONLY_DOWN;
    }
    return (uint8_t)rule;
}

#endif
