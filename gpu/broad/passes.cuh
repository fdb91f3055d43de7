/* SPDX-License-Identifier: Apache-2.0 */
/* Runs many passes over a stream of pairs in one kernel. All threads of the
 * kernel synchronise between passes, so the host neither launches nor reads
 * back between them. spec/gpu.md §6 */
#ifndef GPU_PASSES_CUH
#define GPU_PASSES_CUH

#include "gpu/base/cooperative.cuh"
#include "gpu/broad/bvtt.cuh"

/* Limits that choose how a kernel runs. Up to RANK_ITEMS items for each block
 * of a thread-block cluster, one cluster runs, whose barriers are fast, with no
 * more blocks than have LEAST_ITEMS each. Up to
 * LARGE_ITEMS for each multiprocessor, the whole device runs with large blocks,
 * so that a tile has many threads. Beyond that it runs with small blocks. */
#ifdef __CUDACC__
enum { LEAST_ITEMS = 64, RANK_ITEMS = 256, LARGE_ITEMS = 256 };
enum { SMALL_BLOCKS = 4, LARGE_BLOCK = 1024 };
#else
enum { LEAST_ITEMS = 25, RANK_ITEMS = 100, LARGE_ITEMS = 1000 };
enum { SMALL_BLOCKS = 2, LARGE_BLOCK = BVTT_BLOCK };
#endif

/* Launches a kernel for n items by these limits. The kernel is a template of
 * int BLOCKS, the least number of blocks on a multiprocessor, and bool GRID:
 * whether the whole device runs it, or else one thread-block cluster. */
#define LAUNCH_PASSES(g, n, kernel, ...)                                       \
    do {                                                                       \
        int64_t items_ = (n);                                                  \
        int most_ = ranks_for(items_, LEAST_ITEMS, (g)->ranks);                \
        if (items_ <= in_ranks(g, RANK_ITEMS))                                 \
            LAUNCH_RANKS(g, most_, LARGE_BLOCK, 0, (kernel<1, false>),         \
                         __VA_ARGS__);                                         \
        else if (items_ <= (int64_t)(g)->multiprocessors * LARGE_ITEMS)        \
            LAUNCH_COOPERATIVE(g, 1, LARGE_BLOCK, (kernel<1, true>),           \
                               __VA_ARGS__);                                   \
        else                                                                   \
            LAUNCH_COOPERATIVE(g, SMALL_BLOCKS, BVTT_BLOCK,                    \
                               (kernel<SMALL_BLOCKS, true>), __VA_ARGS__);     \
    } while (0)

/* A stream is processed in tiles of BVTT_BLOCK items, one tile by one block at
 * a time. Of each tile: the number of its outputs, and the place in the output
 * stream where they begin. Both are [blocks_of(cap)], in scratch. */
struct tiles {
    int64_t *sum, *place;
};

/* Takes the scratch for a stream of cap items. Returns false if there is no
 * memory. */
static inline bool take_tiles(struct gpu *g, int64_t cap, struct tiles *t)
{
    int64_t n = blocks_of(cap);
    t->sum = (int64_t *)gpu_scratch(g, SLOT_STAGE, 2 * n, sizeof *t->sum);
    t->place = t->sum + n;
    return t->sum != NULL;
}

/* A block's loop over those of n tiles that are its own. */
#define EACH_TILE(tile, n)                                                     \
    for (int64_t tile = group_rank(); tile < (n); tile += group_ranks())

/* Computes the places of the tiles of this block from the sums of all tiles: an
 * exclusive prefix sum. All sums must be visible. Returns the total in all
 * threads. */
static __device__ inline int64_t place_tiles(const struct tiles *s, int64_t n)
{
    enum { EACH = 8 };
    int64_t all = 0;
    bool in = rank_thread() < BVTT_BLOCK;
    for (int64_t first = 0; first < n; first += EACH * BVTT_BLOCK) {
        int64_t at = first + EACH * (int64_t)rank_thread();
        uint32_t sum[EACH], mine = 0, total;
        for (int k = 0; k < EACH; k++) {
            sum[k] = in && at + k < n ? (uint32_t)s->sum[at + k] : 0;
            mine += sum[k];
        }
        int64_t before = all + block_scan(rank_thread(), mine, &total);
        for (int k = 0; k < EACH; k++) {
            if (in && at + k < n &&
                (uint32_t)(at + k) % (uint32_t)group_ranks() ==
                    (uint32_t)group_rank())
                s->place[at + k] = before;
            before += sum[k];
        }
        all += total;
    }
    __syncthreads();
    return all;
}

#endif
