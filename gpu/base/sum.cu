/* SPDX-License-Identifier: Apache-2.0 */
/* Stages sum and dot on the device: sums by a tree of fixed shape.
 * spec/base/sum.md */
#include "gpu/base/sum.cuh"

/* Words of gpu_words: the sum, written by the block that ends last; the ticket
 * of ends_last. */
enum { VALUE, TICKET };

/* Block k owns chunk k; the block that ends last writes the sum. */
KERNEL sum_kernel(int64_t n, const real *a, real *chunk, int64_t *words)
{
    int64_t item = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real value = item < n ? a[item] : 0, sum;
    bool last = grid_sums<1>(&value, chunk, (unsigned *)(words + TICKET), &sum);
    if (last && threadIdx.x == 0)
        *(real *)(words + VALUE) = sum;
}

/* The same of the dots of a and b, each with its weight. w: NULL, all are 1. */
KERNEL dot_kernel(int64_t n, const vec *a, const vec *b, const real *w,
                  real *chunk, int64_t *words)
{
    int64_t item = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real value = item < n ? dot(a[item], b[item]) : 0, sum;
    if (w && item < n)
        value = w[item] * value;
    bool last = grid_sums<1>(&value, chunk, (unsigned *)(words + TICKET), &sum);
    if (last && threadIdx.x == 0)
        *(real *)(words + VALUE) = sum;
}

static int read_value(struct gpu *g, real *value)
{
    memcpy(value, gpu_read_back(g, 1), sizeof *value);
    return gpu_status(g);
}

int gpu_sum(struct gpu *g, struct sum *s)
{
    int64_t *words = gpu_words(g);
    LAUNCH_BLOCKS(g, sum_chunks(s->n), SUM_CHUNK, sum_kernel, s->n, s->a,
                  s->chunk, words);
    return read_value(g, &s->value);
}

int gpu_dot(struct gpu *g, struct dot *s)
{
    int64_t *words = gpu_words(g);
    LAUNCH_BLOCKS(g, sum_chunks(s->n), SUM_CHUNK, dot_kernel, s->n, s->a, s->b,
                  s->n_w ? s->w : NULL, s->chunk, words);
    return read_value(g, &s->value);
}
