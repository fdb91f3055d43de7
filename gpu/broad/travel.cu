/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the largest relative motion of any candidate's primitives on the
 * device. spec/broad/travel.md */
#include "gpu/base/largest.cuh"
#include "gpu/broad/pair.cuh"

extern "C" {
#include "ref/broad/travel.h"
}

enum { BAD, MOST, WORDS };

/* §1: returns the largest squared relative motion in candidate k. Returns 0 and
 * sets *bad where the candidate is bad. */
static __device__ real relative_motion(const struct travel *s, int64_t k,
                                       int64_t *bad)
{
    int32_t v[4];
    load_pair(s->pair, k, v);
    if (!in_range(v, s->nv) || s->kind[k] > CONTACT_EE) {
        *bad = 1;
        return 0;
    }
    int first = s->kind[k] == CONTACT_EE ? 2 : 1;
    vec d[4];
    real far = 0;
    UNROLL
    for (int j = 0; j < 4; j++)
        d[j] = sub(s->x1[v[j]], s->x0[v[j]]);
    UNROLL
    for (int e = 0; e < 8; e++) {
        int a = e / 4, b = e % 4;
        vec apart = sub(d[a], d[b]);
        if (a < first && b >= first)
            far = max_of(far, dot(apart, apart));
    }
    return far;
}

/* Thread k owns candidate k and reads its vertices at both ends. Each block
 * makes one atomic maximum; the order does not matter. */
KERNEL travel_kernel(const struct travel &s, int64_t *words)
{
    int64_t k = (int64_t)blockIdx.x * GPU_BLOCK + threadIdx.x;
    block_largest(&words[MOST],
                  k < s.n ? relative_motion(&s, k, &words[BAD]) : 0);
}

int gpu_travel(struct gpu *g, struct travel *s)
{
    int64_t *words = gpu_words(g);
    LAUNCH_BLOCKS(g, largest_blocks(s->n), GPU_BLOCK, travel_kernel, *s, words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (seen[BAD])
        return DRAPE_EARG;
    s->most = largest_of(&seen[MOST]);
    return gpu_status(g);
}
