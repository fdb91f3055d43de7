/* SPDX-License-Identifier: Apache-2.0 */
/* Sums on the device: trees of one fixed shape, so that the bits are always the
 * same. spec/base/sum.md §2, §3 */
#ifndef GPU_SUM_CUH
#define GPU_SUM_CUH

#include "gpu/base/cluster.cuh"

extern "C" {
#include "ref/base/sum.h"
}

/* SUM_LAST: the most chunks whose sums the last block keeps in shared memory.
 * They are few in emulation, so that tests reach a level that is kept in global
 * memory.
 */
#ifdef __CUDACC__
enum { SUM_WARPS = SUM_CHUNK / 32, SUM_LAST = SUM_CHUNK };
#else
enum { SUM_WARPS = SUM_CHUNK / 32, SUM_LAST = 2 };
#endif

/* §2: returns the sum of a chunk to all threads of a warp; lane t has s[k] =
 * item t + 32 k of the chunk. Strides of 32 and more are added within a thread,
 * smaller strides between lanes. There both partners add the same two numbers,
 * in either order, so they get the same bits. */
static __device__ inline real warp_sum(real s[SUM_WARPS])
{
    UNROLL
    for (int h = SUM_WARPS / 2; h > 0; h /= 2)
        for (int k = 0; k < h; k++)
            s[k] += s[k + h];
    UNROLL
    for (int h = 16; h > 0; h /= 2)
        s[0] += __shfl_xor_sync(0xffffffffu, s[0], h);
    return s[0];
}

/* Computes N sums over a block of SUM_CHUNK threads, of which each has N
 * values. All threads must call it, and all get the sums. */
template <int N>
static __device__ inline void chunk_sums(const real value[N], real sum[N])
{
    __shared__ real s[N][SUM_CHUNK];
    int t = (int)threadIdx.x;
    __syncthreads(); /* other threads may still read s from the sums before */
    for (int e = 0; e < N; e++)
        s[e][t] = value[e];
    __syncthreads();
    for (int e = 0; e < N; e++) {
        real a[SUM_WARPS];
        UNROLL
        for (int k = 0; k < SUM_WARPS; k++)
            a[k] = s[e][t % 32 + 32 * k];
        sum[e] = warp_sum(a);
    }
}

/* §3: computes one level of N trees. `chunk` holds N runs of n numbers, of
 * which the first `left` are used. Each warp of the block sums one chunk of
 * each run, from chunk `base` on, and all threads of the warp get the N sums.
 */
template <int N>
static __device__ inline void level_sums(int64_t n, int64_t left, int64_t base,
                                         const real *chunk, real sum[N])
{
    int t = (int)threadIdx.x;
    int64_t item = SUM_CHUNK * (base + t / 32) + t % 32;
    real a[N][SUM_WARPS];
    UNROLL
    for (int e = 0; e < N; e++)
        for (int k = 0; k < SUM_WARPS; k++)
            a[e][k] = item + 32 * k < left
                          ? __ldcg(&chunk[e * n + item + 32 * k])
                          : 0;
    UNROLL
    for (int e = 0; e < N; e++)
        sum[e] = warp_sum(a[e]);
}

/* Replaces a level by the next one, in place, in global memory: no number is
 * overwritten before it has been read. Returns how many numbers the next level
 * has. */
template <int N>
static __device__ inline int64_t put_level(int64_t n, int64_t left, real *chunk)
{
    int t = (int)threadIdx.x;
    int64_t chunks = (left + SUM_CHUNK - 1) / SUM_CHUNK;
    real sum[N];
    for (int64_t base = 0; base < chunks; base += SUM_WARPS) {
        level_sums<N>(n, left, base, chunk, sum);
        __syncthreads();
        if (t % 32 == 0 && base + t / 32 < chunks)
            for (int e = 0; e < N; e++)
                chunk[e * n + base + t / 32] = sum[e];
        __syncthreads();
    }
    return chunks;
}

/* Completes N trees from n chunk sums each; all threads of the block get the N
 * sums. The last level is kept in shared memory, since each trip to global
 * memory and back takes half a microsecond. */
template <int N>
static __device__ inline void finish_sums(int64_t n, real *chunk, real sum[N])
{
    __shared__ real last[N][SUM_LAST];
    int t = (int)threadIdx.x;
    int64_t left = n;
    while (left > SUM_LAST * SUM_CHUNK)
        left = put_level<N>(n, left, chunk);
    for (int e = 0; e < N; e++)
        sum[e] = n ? __ldcg(chunk + e * n) : 0;
    if (left <= 1)
        return;
    int chunks = (int)((left + SUM_CHUNK - 1) / SUM_CHUNK);
    for (int base = 0; base < chunks; base += SUM_WARPS) {
        level_sums<N>(n, left, base, chunk, sum);
        if (t % 32 == 0 && base + t / 32 < chunks)
            for (int e = 0; e < N; e++)
                last[e][base + t / 32] = sum[e];
    }
    __syncthreads();
    for (int e = 0; e < N; e++) {
        sum[e] = last[e][0];
        if (chunks == 1)
            continue;
        real a[SUM_WARPS];
        UNROLL
        for (int k = 0; k < SUM_WARPS; k++)
            a[k] = t % 32 + 32 * k < chunks ? last[e][t % 32 + 32 * k] : 0;
        sum[e] = warp_sum(a);
    }
}

/* First step of N sums over many chunks: a block writes the sums of chunk
 * `here` to chunk [N·chunks], which the second step overwrites. */
template <int N>
static __device__ inline void put_sums(const real value[N], int64_t chunks,
                                       int64_t here, real *chunk)
{
    real sum[N];
    chunk_sums<N>(value, sum);
    if (threadIdx.x == 0)
        for (int e = 0; e < N; e++)
            chunk[e * chunks + here] = sum[e];
}

/* Second step, called by each block after it has written its chunk sums.
 * Returns true in all threads of the block that ends last; these get the N
 * sums. */
template <int N>
static __device__ inline bool all_sums(int64_t chunks, real *chunk,
                                       unsigned *ticket, real sum[N])
{
    if (!ends_last(ticket, gridDim.x))
        return false;
    finish_sums<N>(chunks, chunk, sum);
    return true;
}

/* Does both steps, for kernels whose block k owns chunk k. */
template <int N>
static __device__ inline bool grid_sums(const real value[N], real *chunk,
                                        unsigned *ticket, real sum[N])
{
    put_sums<N>(value, gridDim.x, blockIdx.x, chunk);
    return all_sums<N>(gridDim.x, chunk, ticket, sum);
}

/* Returns how many blocks item_sum needs for n items: each warp sums a chunk.
 */
static inline int64_t item_blocks(int64_t n)
{
    return (sum_chunks(n) + SUM_WARPS - 1) / SUM_WARPS;
}

/* Computes the sum of item [n] over the grid, with one chunk for each warp.
 * Returns true in all threads of the block that ends last; these get *sum.
 * Overwrites chunk [sum_chunks(n)]. */
static __device__ inline bool item_sum(int64_t n, const real *item, real *chunk,
                                       unsigned *ticket, real *sum)
{
    int t = (int)threadIdx.x;
    int64_t here = (int64_t)blockIdx.x * SUM_WARPS + t / 32;
    int64_t chunks = (n + SUM_CHUNK - 1) / SUM_CHUNK;
    int64_t first = SUM_CHUNK * here + t % 32;
    real a[SUM_WARPS];
    UNROLL
    for (int k = 0; k < SUM_WARPS; k++)
        a[k] = first + 32 * k < n ? item[first + 32 * k] : 0;
    *sum = warp_sum(a);
    if (t % 32 == 0 && here < chunks)
        chunk[here] = *sum;
    __syncthreads();
    return all_sums<1>(chunks, chunk, ticket, sum);
}

#endif
