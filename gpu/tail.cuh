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
enum { TAIL_MOST = 5000, TAIL_ALONE = 300 };
#else
enum { TAIL_MOST = 100, TAIL_ALONE = 30 };
#endif

/* Couplings that are read at once: all, where registers hold them. */
enum { TAIL_AHEAD = REAL_BITS == 32 ? (int)STENCIL : 4 };

struct tail {
    int levels; /* the last is the coarsest */
    int alone;  /* from this one on by one block */
    struct level level[TAIL_LEVELS];
    struct coarsest coarsest;
    struct weights w;
    const int32_t *go;
};

/* Who works at a grid: the team, or one block alone, whose barriers are
 * quicker and whose streams stay in its cache. */
struct crew {
    int thread, threads;
    bool alone;
};

static __device__ inline void meet(struct crew c)
{
    if (c.alone)
        __syncthreads();
    else
        team_sync();
}

/* All threads of the crew take turns at the particles of a grid. */
#define EACH_OF(c, g, at)                                                      \
    for (struct place at = place_of(g, (c).thread); at.p < (g).m * (g).n;      \
         at = place_of(g, at.p + (c).threads))

template <class END>
static __device__ inline void pass(struct crew c, const struct level *l,
                                   const vec *from, END end)
{
    struct ties t = ties_of(l);
    struct plain x = {from};
    EACH_OF(c, l->g, at)
    {
        auto own = about(&end, at);
        vec here, y = gathered<STENCIL, TAIL_AHEAD>(&t, &x, at, &here);
        arrive(&end, at, own, here, y);
    }
    meet(c);
}

/* From grid `first` to `last`: b of the next one, and its first half-step. */
static __device__ inline void tail_down(const struct tail *s, struct crew crew,
                                        int first, int last)
{
    for (int k = first; k < last; k++) {
        const struct level *l = &s->level[k], *c = l + 1;
        pass(crew, l, l->y, half_down(l, s->w));
        pass(crew, l, l->x, left_after(l));
        EACH_OF(crew, c->g, at)
        restrict_at(l, c, at, k + 2 < s->levels ? s->w.first : 0);
        meet(crew);
    }
}

/* From grid `last` to `first`: x with the correction, smoothed. */
static __device__ inline void tail_up(const struct tail *s, struct crew crew,
                                      int first, int last)
{
    for (int k = last - 1; k >= first; k--) {
        const struct level *l = &s->level[k];
        struct raised x = raised_from(l + 1, l);
        EACH_OF(crew, l->g, at)
        l->x[at.p] = value_at(&x, at);
        meet(crew);
        pass(crew, l, l->x, half_one(l, s->w));
        pass(crew, l, l->y, half_two(l, s->w));
    }
}

/* One team. The right-hand side b of its first grid and the first half-step
 * there are given; its x is the result. */
static __global__ void __launch_bounds__(TAIL_BLOCK)
    tail_kernel(const __grid_constant__ struct tail s)
{
    if (idle(s.go))
        return;
    struct crew team = {team_thread(), team_threads(), false};
    struct crew block = {(int)threadIdx.x, (int)blockDim.x, true};
    int last = s.levels - 1;
    tail_down(&s, team, 0, s.alone);
    if (blockIdx.x == 0) {
        tail_down(&s, block, s.alone, last);
        solve_coarsest(&s.coarsest, s.level[last].b, s.level[last].x);
        __syncthreads();
        tail_up(&s, block, s.alone, last);
    }
    team_sync();
    tail_up(&s, team, 0, s.alone);
}

#endif
