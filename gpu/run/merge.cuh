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

/* What a launch is made of beside its arguments. items: of LAUNCH; else blocks
 * of so many threads, or one cluster of so many ranks and bytes each. */
struct launch_shape {
    int64_t items, blocks, bytes;
    int threads, ranks;
};
typedef void (*launch_rows)(struct gpu *g, const struct launch_shape *s,
                            const void *const *args, int n);

/* Makes a launch with these arguments, or keeps it to be merged. */
void gpu_merge_add(struct gpu *g, struct launch_shape s, launch_rows launch,
                   const void *args, size_t bytes);

/* The arguments of a kernel, and those of N problems. */
template <class... A> struct pack_of;
template <> struct pack_of<> {
};
template <class A, class... B> struct pack_of<A, B...> {
    A first;
    pack_of<B...> others;
};
template <int N, class... A> struct packs {
    pack_of<A...> of[N];
};

static inline pack_of<> pack(void)
{
    return pack_of<>{};
}

template <class A, class... B>
static pack_of<A, B...> pack(A first, B... others)
{
    return pack_of<A, B...>{first, pack(others...)};
}

/* Calls F with the arguments that are left after those given. */
template <class K, K F, class... GIVEN>
static __device__ inline void call(const pack_of<> &, const GIVEN &...given)
{
    F(given...);
}

template <class K, K F, class A, class... B, class... GIVEN>
static __device__ inline void call(const pack_of<A, B...> &a,
                                   const GIVEN &...given)
{
    call<K, F>(a.others, given..., a.first);
}

template <class K, K F, int THREADS, int AT_ONCE, int N, class... A>
static __global__ void __launch_bounds__(THREADS, AT_ONCE)
    merged_kernel(const __grid_constant__ packs<N, A...> s)
{
    call<K, F>(s.of[N == 1 ? 0 : blockIdx.y]);
}

template <int N, class... A>
static packs<N, A...> packs_of(const void *const *from, int n)
{
    packs<N, A...> s = {};
    for (int k = 0; k < n; k++)
        memcpy((void *)&s.of[k], from[k], sizeof s.of[k]);
    return s;
}

/* Calls of the three ways to launch, with N problems of room. */
template <class K, K F, int N, class... A>
static void launch_item_rows(struct gpu *g, const struct launch_shape *s,
                             const void *const *from, int n)
{
    LAUNCH_ITEM_ROWS(g, s->items, n,
                     (merged_kernel<K, F, GPU_BLOCK, 1, N, A...>),
                     packs_of<N, A...>(from, n));
}

template <class K, K F, int THREADS, int AT_ONCE, int N, class... A>
static void launch_block_rows(struct gpu *g, const struct launch_shape *s,
                              const void *const *from, int n)
{
    LAUNCH_ROWS(g, s->blocks, n, s->threads,
                (merged_kernel<K, F, THREADS, AT_ONCE, N, A...>),
                packs_of<N, A...>(from, n));
}

template <class K, K F, int THREADS, int N, class... A>
static void launch_clusters(struct gpu *g, const struct launch_shape *s,
                            const void *const *from, int n)
{
    LAUNCH_CLUSTERS(g, n, s->ranks, s->threads, s->bytes,
                    (merged_kernel<K, F, THREADS, 1, N, A...>),
                    packs_of<N, A...>(from, n));
}

/* MERGE(g, n, (arguments…), kernel) is as LAUNCH, MERGE_BLOCKS(g, blocks,
 * threads, most, at_once, (arguments…), kernel) as LAUNCH_BLOCKS, with at most
 * `most` threads in a block and at least at_once blocks on a multiprocessor,
 * and MERGE_RANKS as LAUNCH_RANKS. kernel: a function of the device, which
 * takes each argument as a value or a const reference. */
#define MERGE(g, n, arguments, ...)                                            \
    merge_items<decltype(&__VA_ARGS__), &__VA_ARGS__>(g, n, MERGED arguments)
#define MERGE_BLOCKS(g, blocks, threads, most, at_once, arguments, ...)        \
    merge_blocks<decltype(&__VA_ARGS__), &__VA_ARGS__, most, at_once>(         \
        g, blocks, threads, MERGED arguments)
#define MERGE_RANKS(g, ranks, threads, bytes, arguments, ...)                  \
    merge_ranks<decltype(&__VA_ARGS__), &__VA_ARGS__, threads>(                \
        g, ranks, bytes, MERGED arguments)
#define MERGED(...) __VA_ARGS__

/* One problem takes a kernel of its own, as arguments at an index that is not
 * known take longer to read. */
template <class K, K F, class... A>
static void merge_items(struct gpu *g, int64_t items, A... a)
{
    pack_of<A...> all = pack(a...);
    auto launch = [](struct gpu *on, const struct launch_shape *s,
                     const void *const *from, int n) {
        if (n == 1)
            launch_item_rows<K, F, 1, A...>(on, s, from, n);
        else
            launch_item_rows<K, F, MERGE_MOST, A...>(on, s, from, n);
    };
    gpu_merge_add(g, {items, 0, 0, 0, 0}, launch, &all, sizeof all);
}

template <class K, K F, int THREADS, int AT_ONCE, class... A>
static void merge_blocks(struct gpu *g, int64_t blocks, int threads, A... a)
{
    pack_of<A...> all = pack(a...);
    auto launch = [](struct gpu *on, const struct launch_shape *s,
                     const void *const *from, int n) {
        if (n == 1)
            launch_block_rows<K, F, THREADS, AT_ONCE, 1, A...>(on, s, from, n);
        else
            launch_block_rows<K, F, THREADS, AT_ONCE, MERGE_MOST, A...>(
                on, s, from, n);
    };
    gpu_merge_add(g, {0, blocks, 0, threads, 0}, launch, &all, sizeof all);
}

template <class K, K F, int THREADS, class... A>
static void merge_ranks(struct gpu *g, int ranks, int64_t bytes, A... a)
{
    pack_of<A...> all = pack(a...);
    auto launch = [](struct gpu *on, const struct launch_shape *s,
                     const void *const *from, int n) {
        if (n == 1)
            launch_clusters<K, F, THREADS, 1, A...>(on, s, from, n);
        else
            launch_clusters<K, F, THREADS, MERGE_MOST, A...>(on, s, from, n);
    };
    gpu_merge_add(g, {0, 0, bytes, THREADS, ranks}, launch, &all, sizeof all);
}

#endif
