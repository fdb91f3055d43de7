/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of candidates and their surfaces on the device: ref/contact.h. */
#ifndef GPU_CONTACT_CUH
#define GPU_CONTACT_CUH

#include "gpu/real.cuh"
#include "ref/contact.h"

/* Candidate k's vertices, in one load. */
static __device__ inline void load_pair(const int32_t *pair, int64_t k,
                                        int32_t v[4])
{
    struct alignas(16) four {
        int32_t v[4];
    } f = ((const struct four *)pair)[k];
    for (int j = 0; j < 4; j++)
        v[j] = f.v[j];
}

static __device__ inline bool in_range(const int32_t v[4], int64_t nv)
{
    bool good = true;
    for (int j = 0; j < 4; j++)
        good = good && v[j] >= 0 && v[j] < nv;
    return good;
}

/* The larger thickness and friction of the four vertices' surfaces. */
static __device__ inline struct surface surface_of(const struct skin *s,
                                                   const int32_t v[4])
{
    struct surface r = s->surface[s->of[v[0]]];
    for (int j = 1; j < 4; j++) {
        struct surface t = s->surface[s->of[v[j]]];
        r.thickness = most(r.thickness, t.thickness);
        r.friction = most(r.friction, t.friction);
    }
    return r;
}

#endif
