/* SPDX-License-Identifier: Apache-2.0 */
/* Pass after pass over a stream of pairs in one kernel: all its threads meet
 * where a launch would end, so the host neither launches nor looks between
 * them. spec/gpu.md §6 */
#ifndef GPU_PASSES_CUH
#define GPU_PASSES_CUH

#include "gpu/base/crowd.cuh"
#include "gpu/broad/bvtt.cuh"

/* Up to so many items a rank are a team's, whose barriers are short; up to so
 * many more a multiprocessor all the device's by large blocks, so that a tile
 * has many threads; more by small ones, which wait for nothing together. */
#ifdef __CUDACC__
enum { RANK_ITEMS = 256, LARGE_ITEMS = 256 };
enum { SMALL_BLOCKS = 4, LARGE_BLOCK = 1024 };
#else
enum { RANK_ITEMS = 100, LARGE_ITEMS = 1000 };
enum { SMALL_BLOCKS = 2, LARGE_BLOCK = BVTT_BLOCK };
#endif

/* kernel is a template of int BLOCKS, bool CROWD: a multiprocessor's blocks at
 * least, and what meet takes. */
#define LAUNCH_PASSES(g, n, kernel, ...)                                       \
    do {                                                                       \
        int64_t items_ = (n);                                                  \
        if (items_ <= (int64_t)(g)->ranks * RANK_ITEMS)                        \
            LAUNCH_TEAM(g, LARGE_BLOCK, 0, (kernel<1, false>), __VA_ARGS__);   \
        else if (items_ <= (int64_t)(g)->crowd * LARGE_ITEMS)                  \
            LAUNCH_CROWD(g, 1, LARGE_BLOCK, (kernel<1, true>), __VA_ARGS__);   \
        else                                                                   \
            LAUNCH_CROWD(g, SMALL_BLOCKS, BVTT_BLOCK,                          \
                         (kernel<SMALL_BLOCKS, true>), __VA_ARGS__);           \
    } while (0)

/* The bounds of such a kernel. */
#define PASSES_BOUNDS(blocks)                                                  \
    __launch_bounds__((blocks) > 1 ? (int)BVTT_BLOCK : (int)LARGE_BLOCK, blocks)

/* What the tiles of a stream become, and where that begins: [blocks_of(cap)]
 * each. A tile is BVTT_BLOCK items, of one rank at a time. */
struct tiles {
    int64_t *sum, *place;
};

/* false: there is no memory. */
static inline bool take_tiles(struct gpu *g, int64_t cap, struct tiles *t)
{
    int64_t n = blocks_of(cap);
    t->sum = (int64_t *)gpu_scratch(g, SLOT_STAGE, 2 * n, sizeof *t->sum);
    t->place = t->sum + n;
    return t->sum != NULL;
}

/* A rank's tiles of n. */
#define EACH_TILE(tile, n)                                                     \
    for (int64_t tile = team_rank(); tile < (n); tile += team_ranks())

/* Behind the barrier after all sums: the places of a rank's tiles, and what all
 * n become, in all threads. */
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
                (uint32_t)(at + k) % (uint32_t)team_ranks() ==
                    (uint32_t)team_rank())
                s->place[at + k] = before;
            before += sum[k];
        }
        all += total;
    }
    __syncthreads();
    return all;
}

#endif
