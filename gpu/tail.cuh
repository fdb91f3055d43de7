/* SPDX-License-Identifier: Apache-2.0 */
/* A cycle's small grids in one kernel: a few blocks that meet at barriers, as
 * a kernel a pass takes longer to start than to run. spec/14_multigrid.md */
#ifndef GPU_TAIL_CUH
#define GPU_TAIL_CUH

#include "gpu/smooth.cuh"

/* TAIL_MOST: particles of its first grid, where a pass is as fast in a kernel
 * of its own; TAIL_LEVELS: so many halvings of those lead to the coarsest. */
enum { TAIL_BLOCK = 256, TAIL_LEVELS = 16 };
#ifdef __CUDACC__
enum { TAIL_MOST = 5000 };
#else
enum { TAIL_MOST = 100 };
#endif

/* Couplings that are read at once: all, where registers hold them. */
enum { TAIL_AHEAD = REAL_BITS == 32 ? (int)STENCIL : 4 };

struct tail {
    int levels; /* the last is the coarsest */
    struct level level[TAIL_LEVELS];
    struct coarsest coarsest;
    struct weights w;
    const int32_t *go;
};

/* All threads of the team take turns at the particles of a grid. */
#define EACH_OF(g, at)                                                         \
    for (struct place at = place_of(g, team_thread()); at.p < (g).m * (g).n;   \
         at = place_of(g, at.p + team_threads()))

template <class END>
static __device__ inline void pass(const struct level *l, const vec *from,
                                   END end)
{
    struct ties t = ties_of(l);
    struct plain x = {from};
    EACH_OF(l->g, at)
    {
        auto own = about(&end, at);
        vec here, y = gathered<STENCIL, TAIL_AHEAD>(&t, &x, at, &here);
        arrive(&end, at, own, here, y);
    }
    team_sync();
}

/* One team. The right-hand side b of its first grid and the first half-step
 * there are given; its x is the result. */
static __global__ void __launch_bounds__(TAIL_BLOCK)
    tail_kernel(const __grid_constant__ struct tail s)
{
    if (idle(s.go))
        return;
    for (int k = 0; k + 1 < s.levels; k++) {
        const struct level *l = &s.level[k], *c = l + 1;
        pass(l, l->y, half_down(l, s.w));
        pass(l, l->x, left_after(l));
        EACH_OF(c->g, at)
        restrict_at(l, c, at, k + 2 < s.levels ? s.w.first : 0);
        team_sync();
    }
    const struct level *last = &s.level[s.levels - 1];
    if (blockIdx.x == 0)
        solve_coarsest(&s.coarsest, last->b, last->x);
    team_sync();
    for (int k = s.levels - 2; k >= 0; k--) {
        const struct level *l = &s.level[k];
        struct raised x = raised_from(l + 1, l);
        EACH_OF(l->g, at)
        l->x[at.p] = value_at(&x, at);
        team_sync();
        pass(l, l->x, half_one(l, s.w));
        pass(l, l->y, half_two(l, s.w));
    }
}

#endif
