/* SPDX-License-Identifier: Apache-2.0 */
/* A crowd: a team of the whole device, so many blocks each multiprocessor. Its
 * blocks meet at crowd_sync and share no memory of their own. */
#ifndef GPU_CROWD_CUH
#define GPU_CROWD_CUH

#include "gpu/base/team.cuh"

/* LAUNCH_CROWD(g, each, threads, kernel, arguments…): `each` blocks of a
 * multiprocessor, which must have room for them. */
#ifdef __CUDACC__
#include <cooperative_groups.h>

#define LAUNCH_CROWD(g, each, threads, kernel, ...)                            \
    do {                                                                       \
        cudaLaunchAttribute together_ = {};                                    \
        together_.id = cudaLaunchAttributeCooperative;                         \
        together_.val.cooperative = 1;                                         \
        cudaLaunchConfig_t config_ = {};                                       \
        config_.gridDim = {(unsigned)((g)->crowd * (each)), 1, 1};             \
        config_.blockDim = {(unsigned)(threads), 1, 1};                        \
        config_.attrs = &together_;                                            \
        config_.numAttrs = 1;                                                  \
        config_.stream = (g)->stream;                                          \
        if (!(g)->failed)                                                      \
            gpu_note((g), cudaLaunchKernelEx(&config_, kernel, __VA_ARGS__));  \
    } while (0)

static __device__ inline void crowd_sync(void)
{
    cooperative_groups::this_grid().sync();
}

#else

#define LAUNCH_CROWD(g, each, threads, kernel, ...)                            \
    do {                                                                       \
        (void)(each);                                                          \
        LAUNCH_TEAM(g, threads, 0, kernel, __VA_ARGS__);                       \
    } while (0)

static inline void crowd_sync(void)
{
    emulate_team_sync(false);
}

#endif

/* All threads of a team, or of a crowd. */
template <bool CROWD> static __device__ inline void meet(void)
{
    if (CROWD)
        crowd_sync();
    else
        team_sync(false);
}

#endif
