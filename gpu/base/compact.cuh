/* SPDX-License-Identifier: Apache-2.0 */
/* Stream compaction within a block: the place of each item that is kept. */
#ifndef GPU_COMPACT_CUH
#define GPU_COMPACT_CUH

#include "gpu/run/launch.cuh"

enum { COMPACT_BLOCK = 256 };

/* Returns how many threads before this one keep their item, and in *total how
 * many threads of the block do. All threads of a block of COMPACT_BLOCK must
 * call it. */
static __device__ inline int block_compact(bool keep, int *total)
{
    __shared__ unsigned word[COMPACT_BLOCK / 32];
    int t = (int)threadIdx.x, rank = 0, sum = 0;
    __syncthreads(); /* other threads may still read word from the call before
                      */
    if (t % 32 == 0)
        word[t / 32] = 0;
    __syncthreads();
    if (keep)
        atomicOr(&word[t / 32], 1u << t % 32);
    __syncthreads();
    for (int k = 0; k < COMPACT_BLOCK / 32; k++) {
        int here = __popc(word[k]);
        rank += k < t / 32 ? here : 0;
        sum += here;
    }
    *total = sum;
    return rank + __popc(word[t / 32] & ((1u << t % 32) - 1));
}

/* Return the number of blocks for n items, and the item of this thread. */
static __host__ __device__ inline int64_t compact_blocks(int64_t n)
{
    return (n + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
}
static __device__ inline int64_t compact_item(void)
{
    return (int64_t)blockIdx.x * COMPACT_BLOCK + threadIdx.x;
}

/* Adds to a counter of gpu_words. Sums of integers do not depend on the order.
 */
static __device__ inline void count_up(int64_t *word, int64_t by)
{
    atomicAdd((unsigned long long *)word, (unsigned long long)by);
}

#endif
