/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the block of a kernel that ends last. That block may combine the
 * results of all blocks, which saves another kernel. */
#ifndef GPU_LAST_BLOCK_CUH
#define GPU_LAST_BLOCK_CUH

#include "gpu/base/real.cuh"

/* Called by all threads after thread 0 has written the result of the block.
 * True in all threads of the block that ends last; it sees the results of all
 * blocks. *ticket is 0 before and after. */
static __device__ inline bool ends_last(unsigned *ticket)
{
    __shared__ bool last;
    if (threadIdx.x == 0) {
        __threadfence(); /* the result is written before the ticket is drawn */
        last = atomicAdd(ticket, 1u) == gridDim.x - 1;
        if (last)
            *ticket = 0;
    }
    __syncthreads();
    __threadfence();
    return last;
}

#endif
