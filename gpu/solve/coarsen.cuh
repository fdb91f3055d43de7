/* SPDX-License-Identifier: Apache-2.0 */
/* The weights by which a grid interpolates from the next coarser grid, and the
 * rules that change them at cuts. spec/solve/multigrid.md §2 */
#ifndef GPU_COARSEN_CUH
#define GPU_COARSEN_CUH

#include "gpu/solve/grid.cuh"

/* Returns twice the weight, along one axis, that a fine particle gives to the
 * coarse particle d fine steps before it. left, right: the fine particle lies
 * between two coarse ones and takes only the left one, or only the right one.
 */
static __device__ inline int axis_part(int d, bool left, bool right)
{
    if (d == 1)
        return right ? 0 : left ? 2 : 1;
    if (d == -1)
        return left ? 0 : right ? 2 : 1;
    return d == 0 ? 2 : 0;
}

/* Returns four times the weight that a fine particle with this rule gives to
 * the coarse particle (di, dj) fine steps before it. */
static __device__ inline int part_of(int rule, int di, int dj)
{
    return axis_part(di, rule & ONLY_LEFT, rule & ONLY_RIGHT) *
           axis_part(dj, rule & ONLY_DOWN, rule & ONLY_UP);
}

static __device__ inline bool tied(sym b)
{
    return b.xx != 0 || b.yy != 0 || b.zz != 0;
}

/* Returns the rule of a particle. right, up: the blocks of all particles to
 * their neighbours to the right and above. */
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
