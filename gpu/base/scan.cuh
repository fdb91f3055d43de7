/* SPDX-License-Identifier: Apache-2.0 */
/* Places in a stream from counts: of a block's threads, of all blocks. */
#ifndef GPU_SCAN_CUH
#define GPU_SCAN_CUH

#include "gpu/run/launch.cuh"

enum { SCAN_BLOCK = 256, SCAN_RUN = 16, SCAN_RUNS = SCAN_BLOCK / SCAN_RUN };

/* What the threads before thread t have together; *total: all of them. Every
 * thread of a block of SCAN_BLOCK must call it; of a larger one too, where only
 * these count. Two counts go at once in the halves of a word, as no block's
 * exceed 16 bits. */
static __device__ inline uint32_t block_scan(int t, uint32_t count,
                                             uint32_t *total)
{
    __shared__ uint32_t s[SCAN_RUNS * (SCAN_RUN + 1)], run[SCAN_RUNS];
    int at = t < SCAN_BLOCK ? t + t / SCAN_RUN : 0; /* no two in one bank */
    __syncthreads(); /* s may be read still from the scan before */
    if (t < SCAN_BLOCK)
        s[at] = count;
    __syncthreads();
    if (t < SCAN_RUNS) {
        uint32_t sum = 0;
        for (int k = t * (SCAN_RUN + 1); k < (t + 1) * (SCAN_RUN + 1) - 1;
             k++) {
            uint32_t here = s[k];
            s[k] = sum;
            sum += here;
        }
        run[t] = sum;
    }
    __syncthreads();
    uint32_t before = 0, all = 0;
    for (int k = 0; k < SCAN_RUNS; k++) {
        before = k == t / SCAN_RUN ? all : before;
        all += run[k];
    }
    *total = all;
    return before + s[at];
}

/* Blocks' counts [n] become the places where each begins. All threads of one
 * block of SCAN_BLOCK call it; a chunk has at most 2^19 · SCAN_BLOCK items. */
static __device__ inline void scan_blocks(int64_t *sum, int64_t n)
{
    enum { EACH = 8 };
    int64_t base = 0;
    for (int64_t first = 0; first < n; first += EACH * SCAN_BLOCK) {
        int64_t at = first + EACH * (int64_t)threadIdx.x;
        uint32_t mine[EACH], all = 0, total;
        for (int k = 0; k < EACH; k++) {
            mine[k] = at + k < n ? (uint32_t)sum[at + k] : 0;
            all += mine[k];
        }
        int64_t before = base + block_scan((int)threadIdx.x, all, &total);
        for (int k = 0; k < EACH && at + k < n; k++) {
            sum[at + k] = before;
            before += mine[k];
        }
        base += total;
    }
}

#endif
