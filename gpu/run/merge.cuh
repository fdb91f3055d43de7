/* SPDX-License-Identifier: Apache-2.0 */
/* Launches for several problems of one size, such as the small cloths of a
 * scene, as one launch each. Between gpu_merge_open and gpu_merge_close nothing
 * is launched; gpu_merge_next says that the launches of the next problem
 * follow. All problems make the same launches with arguments of their own, and
 * gpu_merge_close makes the k-th launches of all as one, whose block (x, y)
 * works for problem y. Else each launch is made at once. spec/gpu.md §9 */
#ifndef GPU_MERGE_CUH
#define GPU_MERGE_CUH

#include "gpu/base/cluster.cuh"

enum { MERGE_MOST = 8 }; /* problems of one launch */

void gpu_merge_open(struct gpu *g);
void gpu_merge_next(struct gpu *g);
void gpu_merge_close(struct gpu *g);

/* A kernel that can be merged, and how n problems of it are launched. */
struct merge_ways {
    const struct kernel_ways *alone;
    void (*merged)(struct gpu *g, const struct launch_shape *s,
                   const void *const *args, int n);
};

/* Makes a launch, or keeps it to be merged. */
void gpu_merge_add(struct gpu *g, const struct merge_ways *m,
                   const struct launch_shape *s, const void *args);

/* The arguments of MERGE_MOST problems. */
template <class ARGS> struct packs {
    ARGS of[MERGE_MOST];
};

template <auto F, class ARGS> KERNEL merged_kernel(const packs<ARGS> &s)
{
    call<F>(s.of[blockIdx.y]);
}

template <auto F, int THREADS, int AT_ONCE, class ARGS>
static void launch_merged(struct gpu *g, const struct launch_shape *s,
                          const void *const *args, int n)
{
    packs<ARGS> all = {};
    struct launch_shape rows = *s;
    for (int k = 0; k < n; k++)
        memcpy((void *)&all.of[k], args[k], sizeof all.of[k]);
    rows.rows = n;
    launch_kernel<&merged_kernel<F, ARGS>, THREADS, AT_ONCE>(g, rows, all);
}

/* Launches F, or keeps the launch to be merged. */
template <auto F, int THREADS, int AT_ONCE, class... A>
static void merge(struct gpu *g, const struct launch_shape &s, A... a)
{
    typedef typename kernel_of<decltype(F)>::args all;
    static const struct merge_ways ways = {
        ways_of<F, THREADS, AT_ONCE>(),
        launch_merged<F, THREADS, AT_ONCE, all>};
    all args = kernel_of<decltype(F)>::of(a...);
    gpu_merge_add(g, &ways, &s, &args);
}

/* MERGE(g, n, (arguments…), kernel) is as LAUNCH, MERGE_BLOCKS(g, blocks,
 * threads, most, at_once, (arguments…), kernel) as LAUNCH_AT_ONCE, with at most
 * `most` threads in a block, and MERGE_RANKS as LAUNCH_RANKS. */
#define MERGE(g, n, arguments, ...)                                            \
    merge<&__VA_ARGS__, GPU_BLOCK, 1>(g, shape_of_items(g, n), MERGED arguments)
#define MERGE_BLOCKS(g, blocks, threads, most, at_once, arguments, ...)        \
    merge<&__VA_ARGS__, most, at_once>(g, shape_of_blocks(blocks, threads),    \
                                       MERGED arguments)
#define MERGE_RANKS(g, ranks, threads, bytes, arguments, ...)                  \
    merge<&__VA_ARGS__, threads, 1>(g, shape_of_ranks(ranks, threads, bytes),  \
                                    MERGED arguments)
#define MERGED(...) __VA_ARGS__

#endif
