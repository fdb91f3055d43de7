/* SPDX-License-Identifier: Apache-2.0 */
/* Which block of a kernel ends last: it may finish what all have begun, where
 * another kernel would do it later. */
#ifndef GPU_LAST_CUH
#define GPU_LAST_CUH

#include "gpu/base/real.cuh"

/* After thread 0 has written what its block found: whether the block ends last,
 * so that what all found is there, in all of its threads. *ticket is 0 before
 * and after. */
static __device__ inline bool ends_last(unsigned *ticket)
{
    __shared__ bool last;
    if (threadIdx.x == 0) {
        __threadfence(); /* it is there before the ticket is drawn */
        last = atomicAdd(ticket, 1u) == gridDim.x - 1;
        if (last)
            *ticket = 0;
    }
    __syncthreads();
    __threadfence();
    return last;
}

#endif
