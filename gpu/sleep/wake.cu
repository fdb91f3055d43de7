/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over what sleeps on the device. spec/sleep/sleep.md */
#include "gpu/base/largest.cuh"

extern "C" {
#include "gpu/run/backend.h"
#include "ref/sleep/wake.h"
}

/* Thread k owns pair k. All threads that write a body's flag write the same. */
KERNEL wake_find_kernel(const struct wake &s)
{
    ITEM(k, s.n);
    uint16_t a = s.body[s.pair[k][0]], b = s.body[s.pair[k][3]];
    if (s.active[a] && !s.active[b])
        s.disturbed[b] = 1;
    if (s.active[b] && !s.active[a])
        s.disturbed[a] = 1;
}

void gpu_wake_find(struct gpu *g, const struct wake *s)
{
    LAUNCH(g, s->n, wake_find_kernel, *s);
}

/* Thread i owns vertex i. */
KERNEL mask_kernel(int64_t n, const uint16_t *body, const uint8_t *awake,
                   uint8_t *mask)
{
    ITEM(i, n);
    mask[i] = awake[body[i]];
}

void gpu_wake_mask(struct gpu *g, int64_t n, const uint16_t *body,
                   const uint8_t *awake, uint8_t *mask)
{
    LAUNCH(g, n, mask_kernel, n, body, awake, mask);
}

/* Thread i owns vertex i. A block within one body makes one atomic maximum; at
 * the border of two bodies each thread makes its own. */
KERNEL ways_kernel(int64_t n, const uint16_t *body, const vec *x0,
                   const vec *x1, int64_t *most)
{
    int64_t first = (int64_t)blockIdx.x * GPU_BLOCK, i = first + threadIdx.x;
    int64_t last = first + GPU_BLOCK <= n ? first + GPU_BLOCK - 1 : n - 1;
    vec d = i < n ? sub(x1[i], x0[i]) : make(0, 0, 0);
    if (body[first] == body[last])
        block_largest(&most[body[first]], dot(d, d));
    else if (i < n)
        note_largest(&most[body[i]], dot(d, d));
}

/* Thread k owns body k. */
KERNEL most_kernel(int64_t bodies, const int64_t *word, real *most)
{
    ITEM(k, bodies);
    real_bits bits = (real_bits)word[k];
    memcpy(&most[k], &bits, sizeof *most);
}

void gpu_wake_displacements(struct gpu *g, int64_t n, const uint16_t *body,
                            const vec *x0, const vec *x1, int bodies,
                            real *most)
{
    size_t size = sizeof(int64_t) + sizeof *most;
    int64_t *word = (int64_t *)gpu_scratch(g, SLOT_STAGE, bodies, size);
    if (!word)
        return;
    real *there = (real *)(word + bodies);
    gpu_clear(g, word, (size_t)bodies * sizeof *word);
    LAUNCH_BLOCKS(g, largest_blocks(n), GPU_BLOCK, ways_kernel, n, body, x0, x1,
                  word);
    LAUNCH(g, bodies, most_kernel, bodies, word, there);
    gpu_down(g, most, there, (size_t)bodies * sizeof *most);
}
