/* SPDX-License-Identifier: Apache-2.0 */
/* Sums by a tree of fixed shape: a block owns a chunk. spec/10_sum.md */
#include "gpu/sum.cuh"

/* Block k owns chunk k: reads a, writes chunk[k]. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    sum_kernel(int64_t n, const real *a, real *chunk)
{
    int64_t item = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real sum = chunk_sum(item < n ? a[item] : 0);
    if (threadIdx.x == 0)
        chunk[blockIdx.x] = sum;
}

static __global__ void __launch_bounds__(SUM_CHUNK) dot_kernel(struct dot s)
{
    int64_t item = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real sum = chunk_sum(item < s.n ? dot(s.a[item], s.b[item]) : 0);
    if (threadIdx.x == 0)
        s.chunk[blockIdx.x] = sum;
}

/* One block: level after level, each in place. A chunk of the next level
 * reads items that no chunk before it writes. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    sum_finish_kernel(int64_t n, real *chunk, real *out)
{
    int64_t left = n;
    while (left > 1) {
        int64_t chunks = (left + SUM_CHUNK - 1) / SUM_CHUNK;
        for (int64_t k = 0; k < chunks; k++) {
            int64_t item = SUM_CHUNK * k + threadIdx.x;
            real sum = chunk_sum(item < left ? chunk[item] : 0);
            if (threadIdx.x == 0)
                chunk[k] = sum;
        }
        __syncthreads();
        left = chunks;
    }
    if (threadIdx.x == 0)
        *out = n ? chunk[0] : 0;
}

void gpu_sum_finish(struct gpu *g, int64_t n, real *chunk, real *out)
{
    LAUNCH_BLOCKS(g, 1, SUM_CHUNK, sum_finish_kernel, n, chunk, out);
}

/* The value that gpu_sum_finish left in the first word. */
static int read_value(struct gpu *g, real *value)
{
    memcpy(value, gpu_read_words(g, 1), sizeof *value);
    return gpu_status(g);
}

int gpu_sum(struct gpu *g, struct sum *s)
{
    int64_t chunks = sum_chunks(s->n);
    LAUNCH_BLOCKS(g, chunks, SUM_CHUNK, sum_kernel, s->n, s->a, s->chunk);
    gpu_sum_finish(g, chunks, s->chunk, (real *)gpu_words(g));
    return read_value(g, &s->value);
}

int gpu_dot(struct gpu *g, struct dot *s)
{
    int64_t chunks = sum_chunks(s->n);
    LAUNCH_BLOCKS(g, chunks, SUM_CHUNK, dot_kernel, *s);
    gpu_sum_finish(g, chunks, s->chunk, (real *)gpu_words(g));
    return read_value(g, &s->value);
}
