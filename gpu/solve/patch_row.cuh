/* SPDX-License-Identifier: Apache-2.0 */
/* Computes a row of A x of a patch (gpu/solve/patch.cuh) by some lanes of a
 * warp. spec/solve/multigrid.md */
#ifndef GPU_PATCH_ROW_CUH
#define GPU_PATCH_ROW_CUH

#include "gpu/solve/edges.cuh"
#include "gpu/solve/patch.cuh"

/* Computes the pulls of the edge that ends at a particle and of the edge that
 * starts there, in one direction; 0 where there is no edge, since adding or
 * subtracting 0 changes no y, which is never -0. x points to x of the particle.
 */
static __device__ inline void pulls_of(struct run r, struct place at,
                                       struct edge t, const struct slot *x,
                                       vec *ending, vec *starting)
{
    int k = (at.p - r.first) * (int)sizeof(sym);
    bool ends = within(r.g, at.i - t.di, at.j - t.dj);
    bool starts = within(r.g, at.i + t.di, at.j + t.dj);
    sym in = fetch(syms((ends ? t.in : t.out) + k)),
        out = fetch(syms(t.out + k));
    vec here = value_of(*x), from = value_of(x[ends ? -t.step : 0]);
    vec to = value_of(x[starts ? t.step : 0]);
    vec none = make(0, 0, 0);
    *ending = ends ? apply(in, sub(from, here)) : none;
    *starting = starts ? apply(out, sub(here, to)) : none;
}

/* Lanes that share a row, and rows of a warp. One number for all grids keeps
 * the code of a row in the instruction cache. Adjacent lanes have adjacent rows
 * and the same directions, so that their blocks are in different banks. */
enum { ROW_LANES = 4, WARP_ROWS = WARP / ROW_LANES };

/* A lane's part of a row. Each lane has the same number of consecutive
 * directions, and the last lane gets the result. */
struct row {
    struct place at;
    int lane;
    bool real, last; /* real: the row exists; last: and this lane gets it */
};

static __device__ inline struct row row_of(struct run r, int item)
{
    int k = item / WARP * WARP_ROWS + item % WARP_ROWS;
    int lane = item % WARP / WARP_ROWS;
    bool real = k < r.own;
    struct place at = place_in(r, real ? r.first + k : 0);
    return row{at, lane, real, real && lane == ROW_LANES - 1};
}

/* A loop in which whole warps take turns at the rows of a run. */
#define EACH_ROW(item, r)                                                      \
    for (int item = rank_thread(),                                             \
             n_ = ((r).own + WARP_ROWS - 1) / WARP_ROWS * WARP;                \
         item < n_; item += rank_threads())

/* Adds the pulls of all edges of a particle to y, which the first lane passes
 * in. The last lane returns the sum. x begins at byte `from` of shared memory.
 * All threads of the warp must call it. It is not inlined, so that its
 * instructions stay in the cache. */
static __device__ __noinline__ vec pulled(struct run r, struct row w, int from,
                                          vec y)
{
    enum { EACH = STENCIL / ROW_LANES };
    const struct slot *x = slots(from) + (w.at.p - r.low);
    vec ending[EACH], starting[EACH];
    UNROLL
    for (int k = 0; k < EACH; k++) {
        ending[k] = starting[k] = make(0, 0, 0);
        if (w.real)
            pulls_of(r, w.at, edges_at(r.table)[w.lane * EACH + k], x,
                     &ending[k], &starting[k]);
    }
    return add_by_lanes<ROW_LANES, WARP_ROWS, EACH>(y, ending, starting,
                                                    w.lane);
}

/* Returns A x at a particle, in the last lane of its row. */
static __device__ inline vec patch_row(const struct patch *l, struct run r,
                                       struct row w, int from)
{
    vec y = make(0, 0, 0);
    if (w.real && w.lane == 0)
        y = own(fetch(syms(excess_of(l, r).at) + (w.at.p - r.first)),
                slot_at(from, w.at.p - r.low));
    return pulled(r, w, from, y);
}

/* Returns gain·F (b - A y) at a particle, in the last lane of its row. */
static __device__ inline vec patch_step(const struct patch *l, struct run r,
                                        struct row w, real gain)
{
    vec y = patch_row(l, r, w, l->y);
    if (!w.last)
        return y;
    sym factor = fetch(syms(factors_of(l, r).at) + (w.at.p - r.low));
    vec b = slot_at(l->x, w.at.p - r.first);
    return scale(gain, solved(factor, sub(b, y)));
}

#endif
