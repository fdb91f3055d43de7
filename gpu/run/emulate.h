/* SPDX-License-Identifier: Apache-2.0 */
/* CUDA's words on the host, as far as gpu/ uses them: so the kernels are
 * compiled, run and compared with ref/ where there is no GPU. Blocks run one
 * after another, last first; threads of a block one after another, or, where
 * they synchronise, as fibers from barrier to barrier, a warp as far as it can
 * without the others; or all of it the other way round, or in an order that is
 * shuffled (gpu_set_way). If between two barriers a thread writes what another
 * reads or writes, one way has other results than the other: so these find
 * wrong results and races, but no others (spec/gpu.md §5). Each thread of
 * the host has a device of its own. */
#ifndef GPU_EMULATE_H
#define GPU_EMULATE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __noinline__
#define __constant__ static const
#define __shared__ static thread_local
#define __launch_bounds__(...)
#define __restrict__
#define __grid_constant__

struct emulate_dim {
    unsigned x, y, z;
};
extern __thread struct emulate_dim blockIdx, threadIdx, gridDim, blockDim;

/* What calls a kernel with its arguments: std::function without its header,
 * which takes half the time that these files compile in. */
struct emulate_call {
    const void *with;
    void (*run)(const void *with);
    template <class F>
    emulate_call(const F &f)
        : with(&f), run([](const void *g) { (*(const F *)g)(); })
    {
    }
};

/* A kernel's call with arguments of its own. */
template <class K, class... A> static auto emulate_bind(K kernel, A... a)
{
    return [=] { kernel(a...); };
}

/* Of a team, gpu/base/team.cuh: its ranks at most, and bytes of a rank's room.
 */
enum { EMULATE_RANKS = 3, EMULATE_ROOM = 1 << 16 };

/* Whether the device is lost (gpu_way.lost): to one more launch, copy or
 * allocation, or to who only asks. What is launched then does nothing, and
 * whoever waits for it is told. */
bool emulate_lost(bool more);

/* A device that is opened runs in another order than the one before. */
void emulate_next_order(void);

void emulate_items(int64_t n, int threads, emulate_call kernel);
void emulate_blocks(int64_t blocks, int threads, emulate_call kernel);
/* One block, whose ranks of `threads` threads have barriers of their own. */
void emulate_team(int ranks, int threads, emulate_call kernel);
extern __thread int emulate_ranks; /* of the team that runs */
char *emulate_room(int rank);      /* [EMULATE_ROOM] poison at first */

/* Of the block, in a team of the rank. Aborts in a kernel of items, and where
 * some threads meet at a barrier of the rank and some at one of the team. */
void __syncthreads(void);
void emulate_meet(void); /* the same, but never left out by gpu_set_way */
void emulate_meet_warp(void);
void emulate_team_sync(bool alone);

/* Copies that are made as late as may be: once copies_end waits for them; at
 * once where threads ascend. */
void emulate_copy(void *to, const void *from, size_t bytes);
void emulate_copies_group(void);
void emulate_copies_end(int left);

/* The value of another thread of the same warp, all threads of which must come
 * to it: it synchronises them, and no others. */
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

/* Blocks run one after another, and nothing is cached. */
static inline void __threadfence(void) {}
template <class T> T __ldcg(const T *a)
{
    return *a;
}

/* Whole numbers only: what a and b make, whatever the order. */
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
static inline int __clz(int a)
{
    return a ? __builtin_clz((unsigned)a) : 32;
}
static inline int __clzll(long long a)
{
    return a ? __builtin_clzll((unsigned long long)a) : 64;
}
static inline uint64_t __umul64hi(uint64_t a, uint64_t b)
{
    __extension__ typedef unsigned __int128 wide;
    return (uint64_t)((wide)a * b >> 64);
}

#endif
