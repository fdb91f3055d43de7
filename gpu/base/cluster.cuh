/* SPDX-License-Identifier: Apache-2.0 */
/* What the blocks of a kernel do together. Thread-block clusters: a few blocks
 * that run at the same time, synchronise and read each other's shared memory.
 * On a device without clusters a cluster is one block. Functions named group_
 * serve cooperative grids (gpu/base/cooperative.cuh), too; a rank is one block
 * of a cluster or grid. */
#ifndef GPU_CLUSTER_CUH
#define GPU_CLUSTER_CUH

#include "gpu/base/real.cuh"

enum { WARP = 32 };

/* LAUNCH_RANKS(g, ranks, threads, bytes, kernel, arguments…) launches one
 * cluster of ranks ≤ g->ranks blocks; each has `bytes` ≤ g->room of shared
 * memory, cluster_shared(). LAUNCH_CLUSTER takes as many as there may be. */
#define LAUNCH_CLUSTER(g, threads, bytes, kernel, ...)                         \
    LAUNCH_RANKS(g, (g)->ranks, threads, bytes, kernel, __VA_ARGS__)
#define LAUNCH_RANKS(g, ranks, threads, bytes, kernel, ...)                    \
    launch_kernel<&kernel, (threads), 1>(                                      \
        g, shape_of_ranks(ranks, threads, bytes), __VA_ARGS__)

#ifdef __CUDACC__
static __device__ inline int group_rank(void)
{
    return (int)blockIdx.x;
}

static __device__ inline int group_ranks(void)
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

static __device__ inline char *cluster_shared(void)
{
    extern __shared__ double2 cluster_words[];
    return (char *)cluster_words;
}

/* Returns the address in the shared memory of another rank that corresponds to
 * p in the own. */
template <class T> static __device__ inline T *cluster_at(T *p, int rank)
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

/* Synchronises the cluster, or with `alone` the own block only. Writes before
 * the barrier are visible after it. */
static __device__ inline void cluster_sync(bool alone)
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

/* The same, but of writes before it only those to the own block's shared memory
 * are visible after it. It takes a thousand clocks less, as nothing has to
 * reach the L2 cache. */
static __device__ inline void cluster_sync_shared(bool alone)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 900
    if (!alone) {
        asm volatile("fence.release.sync_restrict::shared::cta.cluster;\n"
                     "barrier.cluster.arrive.relaxed;\n"
                     "barrier.cluster.wait.acquire;" ::
                         : "memory");
        return;
    }
#endif
    __syncthreads();
}

/* Starts an asynchronous copy of 8 or 16 bytes to shared memory, bypassing L1
 * for 16. The bytes are seen after copies_end and a barrier. copies_group
 * closes a group of such copies. */
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

/* Waits for the copies of this thread, except those of the last LEFT groups. */
template <int LEFT> static __device__ inline void copies_end(void)
{
#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 800
    asm volatile("cp.async.wait_group %0;" ::"n"(LEFT) : "memory");
#endif
}

#else /* emulated, the ranks are parts of one block, gpu/run/emulate.h */

static inline int group_ranks(void)
{
    return emulate_ranks;
}

static inline int rank_threads(void)
{
    return (int)blockDim.x / emulate_ranks;
}

static inline int group_rank(void)
{
    return (int)threadIdx.x / rank_threads();
}

static inline int rank_thread(void)
{
    return (int)threadIdx.x % rank_threads();
}

static inline char *cluster_shared(void)
{
    return emulate_shared(group_rank());
}

template <class T> static inline T *cluster_at(T *p, int rank)
{
    return (T *)((char *)p + (rank - group_rank()) * (int)EMULATE_SHARED);
}

static inline void cluster_sync(bool alone)
{
    emulate_cluster_sync(alone);
}

static inline void cluster_sync_shared(bool alone)
{
    emulate_cluster_sync(alone);
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

/* Returns how many ranks it takes for a rank to get at most so many items, as
 * far as there may be so many: 1, 2, 4, … A rank without items would only hold
 * a multiprocessor. */
static inline int ranks_for(int64_t items, int64_t each, int most)
{
    int ranks = 1;
    while (ranks < most && items > ranks * each)
        ranks *= 2;
    return ranks < most ? ranks : most;
}

/* Returns n rounded up to a multiple of the warp size. */
static __device__ inline int whole_warps(int n)
{
    return (n + WARP - 1) / WARP * WARP;
}

/* Return the value of the lane that is APART lower, or of a given lane. All
 * lanes of the warp must call them. */
template <int APART> static __device__ inline vec lane_below(vec a)
{
#ifdef __CUDACC__
    return make(__shfl_up_sync(0xffffffffu, a.x, APART),
                __shfl_up_sync(0xffffffffu, a.y, APART),
                __shfl_up_sync(0xffffffffu, a.z, APART));
#else
    return __shfl_up_sync(0xffffffffu, a, APART);
#endif
}

template <class T> static __device__ inline T lane_value(T value, int lane)
{
    return __shfl_sync(0xffffffffu, value, lane);
}

#ifdef __CUDACC__
static __device__ inline vec lane_value(vec a, int lane)
{
    return make(lane_value(a.x, lane), lane_value(a.y, lane),
                lane_value(a.z, lane));
}
#endif

/* Loops over n items with all threads of the group. Warps take turns between
 * the ranks, so that each rank gets as many items as the others. */
#define EACH_OF_GROUP(e, n)                                                    \
    for (int e = group_item(), n_ = (int)(n); e < n_;                          \
         e += group_ranks() * rank_threads())

static __device__ inline int group_item(void)
{
    int t = rank_thread(), warp = t / WARP * group_ranks() + group_rank();
    return warp * WARP + t % WARP;
}

/* Finds the block of a kernel that ends last of so many, which may combine the
 * results of all blocks; that saves another kernel. Called by all threads after
 * thread 0 has written the result of the block. True in all threads of the
 * block that ends last; it sees the results of all blocks. *ticket is 0 before
 * and after.
 */
static __device__ inline bool ends_last(unsigned *ticket, int64_t blocks)
{
    __shared__ bool last;
    if (threadIdx.x == 0) {
        __threadfence(); /* the result is written before the ticket is drawn */
        last = atomicAdd(ticket, 1u) == (unsigned)(blocks - 1);
        if (last)
            *ticket = 0;
    }
    __syncthreads();
    __threadfence();
    return last;
}

#endif
