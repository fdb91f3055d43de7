/* SPDX-License-Identifier: Apache-2.0 */
/* The end of every sum on the device. spec/10_sum.md §3 */
#ifndef GPU_SUM_CUH
#define GPU_SUM_CUH

#include "gpu/real.cuh"

/* §2: the sum of the block's SUM_CHUNK values, in all of its threads, halving
 * strides. Every thread of a block of SUM_CHUNK must call it. */
static __device__ inline real chunk_sum(real value)
{
    __shared__ real s[SUM_CHUNK];
    int t = (int)threadIdx.x;
    __syncthreads(); /* s may be read still from the sum before */
    s[t] = value;
    __syncthreads();
    for (int h = SUM_CHUNK / 2; h > 0; h /= 2) {
        if (t < h)
            s[t] += s[t + h];
        __syncthreads();
    }
    return s[0];
}

/* The sum of n chunk sums in `chunk`, which are used up, into *out on the
 * device; 0 where n is 0. */
void gpu_sum_finish(struct gpu *g, int64_t n, real *chunk, real *out);

#endif
