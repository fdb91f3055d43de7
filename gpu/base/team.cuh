/* SPDX-License-Identifier: Apache-2.0 */
/* A team: a few blocks, its ranks, that run at once, meet at barriers and see
 * each other's shared memory. One block where the device cannot. */
#ifndef GPU_TEAM_CUH
#define GPU_TEAM_CUH

#include "gpu/base/real.cuh"

enum { WARP = 32 };

/* LAUNCH_TEAM(g, threads, bytes, kernel, arguments…): one team of g->ranks
 * blocks, each of which has `bytes` ≤ g->room in team_room(). */
#ifdef __CUDACC__
#define LAUNCH_TEAM(g, threads, bytes, kernel, ...)                            \
    do {                                                                       \
        cudaLaunchAttribute cluster_ = {};                                     \
        cluster_.id = cudaLaunchAttributeClusterDimension;                     \
        cluster_.val.clusterDim = {(unsigned)(g)->ranks, 1, 1};                \
        cudaLaunchConfig_t config_ = {};                                       \
        config_.gridDim = {(unsigned)(g)->ranks, 1, 1};                        \
        config_.blockDim = {(unsigned)(threads), 1, 1};                        \
        config_.dynamicSmemBytes = (size_t)(bytes);                            \
        config_.attrs = &cluster_;                                             \
        config_.numAttrs = (g)->ranks > 1 ? 1 : 0;                             \
        config_.stream = (g)->stream;                                          \
        if (!(g)->failed)                                                      \
            gpu_note((g), gpu_allow_team((g), (const void *)(kernel),          \
                                         (bytes) > 0));                        \
        if (!(g)->failed)                                                      \
            gpu_note((g), cudaLaunchKernelEx(&config_, kernel, __VA_ARGS__));  \
    } while (0)

static __device__ inline int team_rank(void)
{
    return (int)blockIdx.x;
}

static __device__ inline int team_ranks(void)
{
    return (int)gridDim.x;
}

static __device__ inline int rank_thread(void)
{
    return (int)threadIdx.x;
}

static __device__ inline int rank_threads(void)
{
    return (int)blockDim.x;
}

static __device__ inline char *team_room(void)
{
    extern __shared__ double2 team_words[];
    return (char *)team_words;
}

/* p of one's own room in the room of another rank. */
template <class T> static __device__ inline T *team_at(T *p, int rank)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 900
    T *there;
    asm("mapa.u64 %0, %1, %2;" : "=l"(there) : "l"(p), "r"(rank));
    return there;
#else
    (void)rank;
    return p;
#endif
}

/* What was written before it, by any thread of the team, or of the rank
 * alone, is seen after. */
static __device__ inline void team_sync(bool alone)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 900
    if (!alone) {
        asm volatile("barrier.cluster.arrive.release;\n"
                     "barrier.cluster.wait.acquire;" ::
                         : "memory");
        return;
    }
#endif
    __syncthreads();
}

/* Copies 8 or 16 bytes to the room, to be seen after copies_end and a barrier;
 * copies_group ends a group of such copies. Past the L1 cache where it can. */
template <class T>
static __device__ inline void copy_ahead(T *to, const T *from)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 800
    unsigned there = (unsigned)__cvta_generic_to_shared(to);
    if (sizeof(T) == 16)
        asm volatile("cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(there),
                     "l"(from)
                     : "memory");
    else
        asm volatile("cp.async.ca.shared.global [%0], [%1], 8;" ::"r"(there),
                     "l"(from)
                     : "memory");
#else
    *to = *from;
#endif
}

static __device__ inline void copies_group(void)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 800
    asm volatile("cp.async.commit_group;" ::: "memory");
#endif
}

/* Waits for the thread's copies, but for those of the last LEFT groups. */
template <int LEFT> static __device__ inline void copies_end(void)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 800
    asm volatile("cp.async.wait_group %0;" ::"n"(LEFT) : "memory");
#endif
}

#else /* the ranks of a team are parts of one block, gpu/run/emulate.h */

#define LAUNCH_TEAM(g, threads, bytes, kernel, ...)                            \
    do {                                                                       \
        int ranks_ = (bytes) > (g)->room ? 0 : (g)->ranks;                     \
        int threads_ = (int)(threads);                                         \
        auto call_ = emulate_bind(kernel, __VA_ARGS__);                        \
        if (!(g)->failed)                                                      \
            emulate_team(ranks_, threads_, call_);                             \
    } while (0)

static inline int team_ranks(void)
{
    return emulate_ranks;
}

static inline int rank_threads(void)
{
    return (int)blockDim.x / emulate_ranks;
}

static inline int team_rank(void)
{
    return (int)threadIdx.x / rank_threads();
}

static inline int rank_thread(void)
{
    return (int)threadIdx.x % rank_threads();
}

static inline char *team_room(void)
{
    return emulate_room(team_rank());
}

template <class T> static inline T *team_at(T *p, int rank)
{
    return (T *)((char *)p + (rank - team_rank()) * (int)EMULATE_ROOM);
}

static inline void team_sync(bool alone)
{
    emulate_team_sync(alone);
}

template <class T> static inline void copy_ahead(T *to, const T *from)
{
    emulate_copy(to, from, sizeof *to);
}

static inline void copies_group(void)
{
    emulate_copies_group();
}

template <int LEFT> static inline void copies_end(void)
{
    emulate_copies_end(LEFT);
}

#endif

/* n rounded up to whole warps. */
static __device__ inline int whole_warps(int n)
{
    return (n + WARP - 1) / WARP * WARP;
}

/* The value of the lane below, or of a certain one; all of the warp call it. */
static __device__ inline vec lane_below(vec a)
{
#ifdef __CUDACC__
    return make(__shfl_up_sync(0xffffffffu, a.x, 1),
                __shfl_up_sync(0xffffffffu, a.y, 1),
                __shfl_up_sync(0xffffffffu, a.z, 1));
#else
    return __shfl_up_sync(0xffffffffu, a, 1);
#endif
}

static __device__ inline double lane_value(double value, int lane)
{
    return __shfl_sync(0xffffffffu, value, lane);
}

/* The threads of a team, warp after warp of rank after rank: as all take long,
 * each rank gets as many. */
#define EACH_OF_TEAM(e, n)                                                     \
    for (int e = team_item(), n_ = (int)(n); e < n_;                           \
         e += team_ranks() * rank_threads())

static __device__ inline int team_item(void)
{
    int t = rank_thread(), warp = t / WARP * team_ranks() + team_rank();
    return warp * WARP + t % WARP;
}

#endif
