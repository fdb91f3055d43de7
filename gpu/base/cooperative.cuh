/* SPDX-License-Identifier: Apache-2.0 */
/* Cooperative grids: all blocks run at the same time, so many on each
 * multiprocessor, and synchronise. They do not see each other's shared memory.
 */
#ifndef GPU_COOPERATIVE_CUH
#define GPU_COOPERATIVE_CUH

#include "gpu/base/cluster.cuh"

/* LAUNCH_COOPERATIVE(g, each, threads, kernel, arguments…) launches `each`
 * blocks for every multiprocessor, which must be able to hold them at once. */
#define LAUNCH_COOPERATIVE(g, each, threads, kernel, ...)                      \
    launch_kernel<&kernel, (threads), (each)>(                                 \
        g, shape_of_grid(g, each, threads), __VA_ARGS__)

/* Returns up to how many items one cluster takes and not the whole device, of
 * which each rank takes `each`. A batch has few ranks, and the device is busy
 * with other worlds. */
static inline int64_t in_ranks(const struct gpu *g, int64_t each)
{
    enum { PATIENT = 64 };
    return (g->together ? PATIENT : 1) * (int64_t)g->ranks * each;
}

#ifdef __CUDACC__
#include <cooperative_groups.h>

static __device__ inline void grid_sync(void)
{
    cooperative_groups::this_grid().sync();
}

#else

static inline void grid_sync(void)
{
    emulate_cluster_sync(false);
}

#endif

/* Synchronises all threads of a cluster, or of a cooperative grid. */
template <bool GRID> static __device__ inline void group_sync(void)
{
    if (GRID)
        grid_sync();
    else
        cluster_sync(false);
}

#endif
