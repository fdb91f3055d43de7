/* SPDX-License-Identifier: Apache-2.0 */
/* Emulates as much of CUDA on the host as gpu/ uses, so that kernels are
 * compiled, run and compared with ref/ where there is no GPU. Blocks run one
 * after another, the last first. The threads of a block run one after another;
 * in kernels that synchronise they are fibers that run from barrier to barrier,
 * each warp as far as it can without the others. gpu_set_way turns all of these
 * orders round, or shuffles them. If a thread writes between two barriers what
 * another thread reads or writes, the orders give different results; that is
 * how the emulation finds wrong results and races, and no other faults
 * (spec/gpu.md §5). Each thread of the host has a device of its own. */
#ifndef GPU_EMULATE_H
#define GPU_EMULATE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define __global__
#define __device__
#define __host__
#define __noinline__
#define __shared__ static thread_local
#define __launch_bounds__(...)
#define __grid_constant__

struct emulate_dim {
    unsigned x, y, z;
};
extern __thread struct emulate_dim blockIdx, threadIdx, gridDim, blockDim;

/* A call of a kernel with its arguments. */
struct emulate_call {
    void (*run)(const void *with);
    const void *with;
    emulate_call(void (*run)(const void *with), const void *with)
        : run(run), with(with)
    {
    }
};

/* The most blocks of a cluster, and the bytes of shared memory of each. */
enum { EMULATE_RANKS = 3, EMULATE_SHARED = 1 << 16 };

/* Whether the device is lost (gpu_way.lost). more: this call is one more
 * launch, copy or allocation. Launches on a lost device do nothing, and waiting
 * for them gives an error. */
bool emulate_lost(bool more);

/* Called when a device is opened: it runs in another order than the one before.
 */
void emulate_next_order(void);

/* Each of the three runs row after row. */
void emulate_items(int64_t n, int rows, int threads, emulate_call kernel);
void emulate_blocks(int64_t blocks, int rows, int threads, emulate_call kernel);
/* A cluster, as one block that has parts (ranks) of `threads` threads each,
 * with barriers of their own. */
void emulate_cluster(int ranks, int rows, int threads, emulate_call kernel);
extern __thread int emulate_ranks; /* of the cluster that runs */
char *emulate_shared(int rank);    /* [EMULATE_SHARED] filled with poison */

/* Barrier of the block; in a cluster, of the rank. Aborts in a kernel of items,
 * and if some threads are at a barrier of their rank while others are at one of
 * the cluster. */
void __syncthreads(void);
void emulate_meet(void); /* the same, but gpu_set_way never leaves it out */
void emulate_meet_warp(void);
void emulate_cluster_sync(bool alone);

/* Asynchronous copies. They are made as late as is allowed, when copies_end
 * waits for them; or at once where threads run in ascending order. */
void emulate_copy(void *to, const void *from, size_t bytes);
void emulate_copies_group(void);
void emulate_copies_end(int left);

/* The value of another thread of the same warp. All threads of the warp must
 * call it; it synchronises them, and no others. */
extern __thread unsigned char emulate_lane[1024][32];
template <class T> static T emulate_from(T value, unsigned thread)
{
    memcpy(emulate_lane[threadIdx.x], &value, sizeof value);
    emulate_meet_warp();
    memcpy(&value, emulate_lane[thread], sizeof value);
    emulate_meet_warp();
    return value;
}
template <class T> static T __shfl_xor_sync(unsigned, T value, int mask)
{
    return emulate_from(value, threadIdx.x ^ (unsigned)mask);
}
template <class T> static T __shfl_up_sync(unsigned, T value, unsigned by)
{
    unsigned t = threadIdx.x;
    return emulate_from(value, t % 32 < by ? t : t - by);
}
template <class T> static T __shfl_sync(unsigned, T value, int lane)
{
    return emulate_from(value, threadIdx.x / 32 * 32 + (unsigned)lane);
}

static inline void __syncwarp(void)
{
    emulate_meet_warp();
}

/* Blocks run one after another and nothing is cached, so fences do nothing. */
static inline void __threadfence(void) {}
template <class T> T __ldcg(const T *a)
{
    return *a;
}

/* Atomics of integers, whose results do not depend on the order. */
template <class T, class V> T atomicAdd(T *a, V b)
{
    T old = *a;
    *a = (T)(old + (T)b);
    return old;
}
template <class T, class V> T atomicMin(T *a, V b)
{
    T old = *a;
    *a = (T)b < old ? (T)b : old;
    return old;
}
template <class T, class V> T atomicMax(T *a, V b)
{
    T old = *a;
    *a = (T)b > old ? (T)b : old;
    return old;
}
template <class T, class V> T atomicOr(T *a, V b)
{
    T old = *a;
    *a = (T)(old | (T)b);
    return old;
}
template <class T, class U, class V> T atomicCAS(T *a, U want, V b)
{
    T old = *a;
    *a = old == (T)want ? (T)b : old;
    return old;
}

static inline int __popc(unsigned a)
{
    return __builtin_popcount(a);
}
static inline int __clzll(long long a)
{
    return a ? __builtin_clzll((unsigned long long)a) : 64;
}

#endif
