/* SPDX-License-Identifier: Apache-2.0 */
/* Puts the vertices of touching pairs back to the start of the step.
 * spec/contact/rollback.md */
#include "gpu/base/compact.cuh"
#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/rollback.h"
}

enum { BAD, TRAPPED, GROWN, WORDS };

static __device__ bool can_go(const struct rollback *s, int64_t i)
{
    return s->w[i] > 0 && !s->rolled[i];
}

/* Thread k owns pair k: marks its vertices that can be rolled back; all threads
 * write the same 1. Counts the pair as trapped if there is no such vertex. */
KERNEL rollback_mark_kernel(const struct rollback &s, int64_t *words)
{
    ITEM(k, s.n);
    int32_t v[4];
    load_pair(s.pair, k, v);
    if (!in_range(v, s.nv)) {
        words[BAD] = 1;
        return;
    }
    bool any = false;
    for (int j = 0; j < 4; j++)
        if (can_go(&s, v[j])) {
            s.touched[v[j]] = 1;
            any = true;
        }
    if (!any)
        count_up(&words[TRAPPED], 1);
}

/* A block owns COMPACT_BLOCK vertices, a thread one vertex: rolls it back if it
 * is marked, or if all vertices go back. */
KERNEL rollback_send_kernel(const struct rollback &s, int64_t *words)
{
    int64_t i = compact_item();
    bool goes = false;
    if (i < s.nv && !words[BAD]) {
        bool all = s.all && s.n > words[TRAPPED];
        goes = s.touched[i] || (all && can_go(&s, i));
    }
    int count;
    block_compact(goes, &count);
    if (threadIdx.x == 0 && count)
        count_up(&words[GROWN], count);
    if (!goes)
        return;
    s.touched[i] = s.rolled[i] = 1;
    s.x1[i] = s.x0[i];
    s.u[i] = s.v[i] = make(0, 0, 0);
}

int gpu_rollback(struct gpu *g, struct rollback *s)
{
    int64_t *words = gpu_words(g);
    gpu_clear(g, s->touched, (size_t)s->nv);
    LAUNCH(g, s->n, rollback_mark_kernel, *s, words);
    LAUNCH_BLOCKS(g, compact_blocks(s->nv), COMPACT_BLOCK, rollback_send_kernel,
                  *s, words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    s->trapped = seen[TRAPPED];
    s->grown = seen[GROWN];
    return seen[BAD] ? DRAPE_EARG : gpu_status(g);
}
