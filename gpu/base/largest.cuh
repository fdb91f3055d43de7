/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the largest of many reals with an atomic maximum on integers, in a word
 * that starts at 0. The bits of positive reals have the order of the reals, and
 * the order of the threads does not affect a maximum. */
#ifndef GPU_LARGEST_CUH
#define GPU_LARGEST_CUH

#include "gpu/base/real.cuh"

/* Sets the word to the bits of value if value is larger. value ≥ 0 or NaN. */
static __device__ inline void note_largest(int64_t *word, real value)
{
    real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    if (value > 0 && (int64_t)bits > *word)
        atomicMax((unsigned long long *)word, (unsigned long long)bits);
}

/* Does the same with the largest value of a block. Each thread has a value, and
 * all threads must call it. */
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
