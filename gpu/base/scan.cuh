/* SPDX-License-Identifier: Apache-2.0 */
/* Exclusive scans of counts: within a block, and over the counts of all blocks.
 * They give each item its place in a stream. */
#ifndef GPU_SCAN_CUH
#define GPU_SCAN_CUH

#include "gpu/run/launch.cuh"

enum { SCAN_BLOCK = 256, SCAN_RUN = 16, SCAN_RUNS = SCAN_BLOCK / SCAN_RUN };

/* Returns the sum of the counts of the threads before thread t, and in *total
 * the sum of all. Every thread of the block must call it; in a block larger
 * than SCAN_BLOCK only the first SCAN_BLOCK threads count. Two counts can be
 * scanned at once, one in each half of a word, as the totals of a block fit in
 * 16 bits. */
static __device__ inline uint32_t block_scan(int t, uint32_t count,
                                             uint32_t *total)
{
    __shared__ uint32_t s[SCAN_RUNS * (SCAN_RUN + 1)], run[SCAN_RUNS];
    int at = t < SCAN_BLOCK ? t + t / SCAN_RUN : 0; /* avoids bank conflicts */
    __syncthreads(); /* other threads may still read s from the scan before */
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

/* Turns the counts [n] of blocks into the place where each block begins. All
 * threads of one block of SCAN_BLOCK must call it. The counts that one pass of
 * the loop adds up must stay below 2^32. */
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
