/* SPDX-License-Identifier: Apache-2.0 */
/* Compiles kernels of gpu/ from their own sources, under names that end with
 * FLAGS, the name of the set of compiler flags. */
#include "bench/price.h"
#include "gpu/base/sum.cuh"
#include "gpu/cloth/cloth.cuh"

#define PASTE_(a, b) a##_##b
#define PASTE(a, b) PASTE_(a, b)
#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)

/* These must not replace the library's functions, which have other flags. */
#undef gpu_springs
#undef gpu_sum
#undef gpu_dot
#define gpu_springs PASTE(gpu_springs, PASTE(FLAGS, REAL_BITS))
#define gpu_sum PASTE(gpu_sum, PASTE(FLAGS, REAL_BITS))
#define gpu_dot PASTE(gpu_dot, PASTE(FLAGS, REAL_BITS))
#include "gpu/base/sum.cu"
#include "gpu/cloth/springs.cu"

enum { LOOSE_BLOCKS = 132 * 8 };

/* Each thread sums its items, each warp the sums of its threads, and atomic
 * additions the sums of the warps, in no fixed order. */
KERNEL loose_kernel(int64_t n, const vec *a, const vec *b, int64_t *word)
{
    int64_t first = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real sum = 0;
    for (int64_t k = first; k < n; k += (int64_t)gridDim.x * SUM_CHUNK)
        sum += dot(a[k], b[k]);
    for (int h = 16; h > 0; h /= 2)
        sum += __shfl_xor_sync(0xffffffffu, sum, h);
    if (threadIdx.x % 32 == 0)
        atomicAdd((real *)word, sum);
}

static void springs(struct gpu *g, const struct springs *s)
{
    struct springs copy = *s;
    gpu_springs(g, &copy);
}

static void ordered(struct gpu *g, const struct dot *s, int64_t *word)
{
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, dot_kernel, s->n, s->a, s->b,
                  s->chunk, word);
}

static void loose(struct gpu *g, const struct dot *s, int64_t *word)
{
    gpu_clear(g, word, sizeof *word);
    LAUNCH_BLOCKS(g, LOOSE_BLOCKS, SUM_CHUNK, loose_kernel, s->n, s->a, s->b,
                  word);
}

/* price.h adds the suffix of the precision to this name. */
const struct price PASTE(price, FLAGS) = {TEXT(FLAGS), springs, ordered, loose};
