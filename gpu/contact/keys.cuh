/* SPDX-License-Identifier: Apache-2.0 */
/* The keys of pairs on the device. spec/contact/impulses.md §1 */
#ifndef GPU_CONTACT_KEYS_CUH
#define GPU_CONTACT_KEYS_CUH

#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/base/keys.h"
}

/* Bit 63 of hi: the pair is of two edges. */
#define KEY_EDGES (1ull << 63)

static __device__ inline uint64_t key_join(int32_t a, int32_t b)
{
    return (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
}

/* An edge, whichever of its ends is named first. */
static __device__ inline uint64_t key_edge(int32_t a, int32_t b)
{
    return key_join(min_of(a, b), max_of(a, b));
}

/* The key of a pair, the same in whatever order its vertices are named. */
static __device__ inline struct key pair_key(const int32_t v[4], int64_t kind,
                                             int64_t item)
{
    if (kind == CONTACT_EE) {
        uint64_t a = key_edge(v[0], v[1]), b = key_edge(v[2], v[3]);
        struct key r = {min_of(a, b) | KEY_EDGES, max_of(a, b), item};
        return r;
    }
    int32_t lo = min_of(v[1], v[2]), hi = max_of(v[1], v[2]);
    int32_t first = min_of(lo, v[3]), last = max_of(hi, v[3]);
    int32_t middle = max_of(lo, min_of(hi, v[3]));
    struct key r = {key_join(v[0], first), key_join(middle, last), item};
    return r;
}

#endif
