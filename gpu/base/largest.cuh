/* SPDX-License-Identifier: Apache-2.0 */
/* The largest of many reals, as the bits of a word that starts at 0. The bits
 * of positive reals are ordered as the reals are, so an integer atomic finds
 * the largest, and no order shows. */
#ifndef GPU_LARGEST_CUH
#define GPU_LARGEST_CUH

#include "gpu/base/real.cuh"

/* word becomes the bits of value if value is larger. value ≥ 0 or NaN. */
static __device__ inline void note_largest(int64_t *word, real value)
{
    real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    if (value > 0 && (int64_t)bits > *word)
        atomicMax((unsigned long long *)word, (unsigned long long)bits);
}

/* The same for a block: each thread has a value, and all must call it. */
static __device__ inline void block_largest(int64_t *word, real value)
{
    __shared__ real a[GPU_BLOCK];
    int t = (int)threadIdx.x;
    a[t] = value;
    for (int half = GPU_BLOCK / 2; half > 0; half /= 2) {
        __syncthreads();
        if (t < half)
            a[t] = max_of(a[t], a[t + half]);
    }
    if (t == 0)
        note_largest(word, a[0]);
}

static inline int64_t largest_blocks(int64_t n)
{
    return (n + GPU_BLOCK - 1) / GPU_BLOCK;
}

static inline real largest_of(const int64_t *word)
{
    real value;
    real_bits bits = (real_bits)*word;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
