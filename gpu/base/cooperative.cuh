/* SPDX-License-Identifier: Apache-2.0 */
/* Cooperative grids: all blocks run at the same time, so many on each
 * multiprocessor, and synchronise. They do not see each other's shared memory.
 */
#ifndef GPU_COOPERATIVE_CUH
#define GPU_COOPERATIVE_CUH

#include "gpu/base/cluster.cuh"

/* LAUNCH_COOPERATIVE(g, each, threads, kernel, arguments…) launches `each`
 * blocks for every multiprocessor, which must be able to hold them at once. */
#ifdef __CUDACC__
#include <cooperative_groups.h>

#define LAUNCH_COOPERATIVE(g, each, threads, kernel, ...)                      \
    do {                                                                       \
        cudaLaunchAttribute together_ = {};                                    \
        together_.id = cudaLaunchAttributeCooperative;                         \
        together_.val.cooperative = 1;                                         \
        cudaLaunchConfig_t config_ = {};                                       \
        config_.gridDim = {(unsigned)((g)->multiprocessors * (each)), 1, 1};   \
        config_.blockDim = {(unsigned)(threads), 1, 1};                        \
        config_.attrs = &together_;                                            \
        config_.numAttrs = 1;                                                  \
        config_.stream = (g)->stream;                                          \
        if (!(g)->failed)                                                      \
            gpu_note((g), cudaLaunchKernelEx(&config_, kernel, __VA_ARGS__));  \
    } while (0)

static __device__ inline void grid_sync(void)
{
    cooperative_groups::this_grid().sync();
}

#else

#define LAUNCH_COOPERATIVE(g, each, threads, kernel, ...)                      \
    do {                                                                       \
        (void)(each);                                                          \
        LAUNCH_CLUSTER(g, threads, 0, kernel, __VA_ARGS__);                    \
    } while (0)

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
