/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates on the device, as in ref/broad/pair.h. spec/broad/features.md */
#ifndef GPU_PAIR_CUH
#define GPU_PAIR_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/broad/pair.h"
}

/* A candidate's vertices, read by one 16-byte load. */
struct alignas(16) pair_vertices {
    int32_t v[4];
};

static __device__ inline void load_pair(const int32_t *pair, int64_t k,
                                        int32_t v[4])
{
    struct pair_vertices f = ((const struct pair_vertices *)pair)[k];
    for (int j = 0; j < 4; j++)
        v[j] = f.v[j];
}

/* Copies pair k to place `at` of `to`. */
static __device__ inline void copy_pair(const int32_t *pair, int64_t k,
                                        int32_t *to, int64_t at)
{
    ((struct pair_vertices *)to)[at] = ((const struct pair_vertices *)pair)[k];
}

static __device__ inline bool in_range(const int32_t v[4], int64_t nv)
{
    bool good = true;
    for (int j = 0; j < 4; j++)
        good = good && v[j] >= 0 && v[j] < nv;
    return good;
}

#endif
