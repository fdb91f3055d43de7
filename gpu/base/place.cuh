/* SPDX-License-Identifier: Apache-2.0 */
/* Which place an item that is kept has among those of its block. */
#ifndef GPU_PLACE_CUH
#define GPU_PLACE_CUH

#include "gpu/run/launch.cuh"

enum { PLACE_BLOCK = 256 };

/* The number of threads before this one that keep theirs; *total: of all.
 * Every thread of a block of PLACE_BLOCK must call it. */
static __device__ inline int block_place(bool keep, int *total)
{
    __shared__ unsigned word[PLACE_BLOCK / 32];
    int t = (int)threadIdx.x, rank = 0, sum = 0;
    __syncthreads(); /* word may be read still from the call before */
    if (t % 32 == 0)
        word[t / 32] = 0;
    __syncthreads();
    if (keep)
        atomicOr(&word[t / 32], 1u << t % 32);
    __syncthreads();
    for (int k = 0; k < PLACE_BLOCK / 32; k++) {
        int here = __popc(word[k]);
        rank += k < t / 32 ? here : 0;
        sum += here;
    }
    *total = sum;
    return rank + __popc(word[t / 32] & ((1u << t % 32) - 1));
}

/* Blocks of n items, and a thread's item. */
static inline int64_t place_blocks(int64_t n)
{
    return (n + PLACE_BLOCK - 1) / PLACE_BLOCK;
}
static __device__ inline int64_t place_item(void)
{
    return (int64_t)blockIdx.x * PLACE_BLOCK + threadIdx.x;
}

/* Adds to a counter of gpu_words, whose order does not show. */
static __device__ inline void count_up(int64_t *word, int64_t by)
{
    atomicAdd((unsigned long long *)word, (unsigned long long)by);
}

#endif
