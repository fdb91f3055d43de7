/* SPDX-License-Identifier: Apache-2.0 */
/* The largest of many reals on the device, as bits of a word that starts at 0:
 * whole numbers order positive reals alike, so no order shows. */
#ifndef GPU_LARGEST_CUH
#define GPU_LARGEST_CUH

#include "gpu/real.cuh"

/* *word becomes the bits of value where that is larger. value ≥ 0 or NaN. */
static __device__ inline void note_largest(int64_t *word, real value)
{
    real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    if (value > 0 && (int64_t)bits > *word)
        atomicMax((unsigned long long *)word, (unsigned long long)bits);
}

static inline real largest_of(const int64_t *word)
{
    real value;
    real_bits bits = (real_bits)*word;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
