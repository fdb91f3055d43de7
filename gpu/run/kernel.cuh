/* SPDX-License-Identifier: Apache-2.0 */
/* What a launch is made of. Every launch goes through gpu_launch, which makes
 * it at once, or keeps it until worlds of a batch have the same one to make
 * (gpu/run/batch.cuh). Included by gpu/run/launch.cuh. */
#ifndef GPU_KERNEL_CUH
#define GPU_KERNEL_CUH

#include <type_traits>

/* How the blocks of a launch belong together: of items, a launch may have more
 * blocks than it needs; of parts, blocks beyond those of a world do nothing,
 * and none asks how many there are; ranks are one cluster; a grid is
 * cooperative. */
enum launch_kind { OF_ITEMS, OF_PARTS, OF_BLOCKS, OF_RANKS, OF_GRID };

/* What a launch is made of beside its kernel and arguments. items: OF_ITEMS
 * alone; rows: problems whose number is blockIdx.y; bytes: of shared memory,
 * cluster_shared(). */
struct launch_shape {
    enum launch_kind kind;
    int threads, rows;
    int64_t items, blocks, bytes;
};

static inline struct launch_shape shape_of_items(const struct gpu *g, int64_t n)
{
    return {OF_ITEMS, g->block, 1, n, (n + g->block - 1) / g->block, 0};
}

static inline struct launch_shape shape_of_parts(int64_t blocks, int threads)
{
    return {OF_PARTS, threads, 1, 0, blocks, 0};
}

static inline struct launch_shape shape_of_blocks(int64_t blocks, int threads)
{
    return {OF_BLOCKS, threads, 1, 0, blocks, 0};
}

static inline struct launch_shape shape_of_ranks(int ranks, int threads,
                                                 int64_t bytes)
{
    return {OF_RANKS, threads, 1, 0, ranks, bytes};
}

static inline struct launch_shape shape_of_grid(const struct gpu *g, int each,
                                                int threads)
{
#ifdef __CUDACC__
    return {OF_GRID, threads, 1, 0, (int64_t)g->multiprocessors * each, 0};
#else
    (void)each;
    return {OF_GRID, threads, 1, 0, g->ranks, 0};
#endif
}

/* A kernel as it is launched, with the bytes of its arguments, and of those of
 * one of many worlds (struct world_args). `one` takes its arguments as a
 * parameter, `many` a pointer to those of several worlds, whose number is
 * blockIdx.z. */
struct kernel_ways {
    size_t bytes, world_bytes;
#ifdef __CUDACC__
    const void *one, *many;
#else
    void (*run)(const void *args);
#endif
};

#ifdef __CUDACC__
/* Loads all kernels that launch for one world. */
void gpu_load_kernels(struct gpu *g);
#endif
/* Makes a launch, or keeps it for the batch of g's world. */
void gpu_launch(struct gpu *g, const struct kernel_ways *k,
                const struct launch_shape *s, const void *args);
/* Makes a launch: args of one world, in host memory, or, with worlds > 1, of so
 * many in device memory. */
void gpu_launch_now(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *s, const void *args, int worlds);

/* The arguments of a kernel, in one struct. */
template <class... A> struct pack_of;
template <> struct pack_of<> {
};
template <class A, class... B> struct pack_of<A, B...> {
    A first;
    pack_of<B...> others;
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

/* The arguments that a kernel takes, as values. */
template <class F> struct kernel_of;
template <class... P> struct kernel_of<void (*)(P...)> {
    template <class T>
    using value = std::remove_cv_t<std::remove_reference_t<T>>;
    typedef pack_of<value<P>...> args;
    static args of(value<P>... p) { return pack(p...); }
};

/* Calls F with the arguments that are left after those given. */
template <auto F, class... GIVEN>
static __device__ inline void call(const pack_of<> &, const GIVEN &...given)
{
    F(given...);
}

template <auto F, class A, class... B, class... GIVEN>
static __device__ inline void call(const pack_of<A, B...> &a,
                                   const GIVEN &...given)
{
    call<F>(a.others, given..., a.first);
}

/* The arguments of one of many worlds, and the number of blocks of it that have
 * work. */
struct world_head {
    int64_t blocks, unused;
};
template <class ARGS> struct alignas(16) world_args {
    struct world_head head;
    ARGS args;
};

#ifdef __CUDACC__
template <auto F, int THREADS, int AT_ONCE, class ARGS>
static __global__ void __launch_bounds__(THREADS, AT_ONCE)
    one_kernel(const __grid_constant__ ARGS a)
{
    call<F>(a);
}

template <auto F, int THREADS, int AT_ONCE, class ARGS>
static __global__ void __launch_bounds__(THREADS, AT_ONCE)
    many_kernel(const world_args<ARGS> *__restrict__ of)
{
    if (blockIdx.x < of[blockIdx.z].head.blocks)
        call<F>(of[blockIdx.z].args);
}
#endif

#ifdef __CUDACC__
/* A kernel in the list of all kernels of the program. A device loads them when
 * it is opened, as else CUDA would load each in the step that first launches
 * it. */
struct known_kernel {
    const void *one;
    struct known_kernel *next;
};
/* Puts a kernel into the list, before main begins. Returns true. */
bool gpu_know_kernel(struct known_kernel *k);

template <auto F, int THREADS, int AT_ONCE, class ARGS> struct known {
    static struct known_kernel kernel;
    static const bool listed;
};
template <auto F, int THREADS, int AT_ONCE, class ARGS>
struct known_kernel known<F, THREADS, AT_ONCE, ARGS>::kernel = {
    (const void *)one_kernel<F, THREADS, AT_ONCE, ARGS>, NULL
};
template <auto F, int THREADS, int AT_ONCE, class ARGS>
const bool known<F, THREADS, AT_ONCE, ARGS>::listed = gpu_know_kernel(&kernel);
#endif

template <auto F, int THREADS, int AT_ONCE>
static const struct kernel_ways *ways_of(void)
{
    typedef typename kernel_of<decltype(F)>::args args;
#ifdef __CUDACC__
    (void)&known<F, THREADS, AT_ONCE, args>::listed;
    static const struct kernel_ways ways = {
        sizeof(args), sizeof(world_args<args>),
        (const void *)one_kernel<F, THREADS, AT_ONCE, args>,
        (const void *)many_kernel<F, THREADS, AT_ONCE, args>};
#else
    static const struct kernel_ways ways = {
        sizeof(args), sizeof(world_args<args>),
        [](const void *a) { call<F>(*(const args *)a); }};
#endif
    return &ways;
}

/* Launches F, whose blocks have at most THREADS threads. */
template <auto F, int THREADS, int AT_ONCE, class... A>
static void launch_kernel(struct gpu *g, const struct launch_shape &s, A... a)
{
    auto args = kernel_of<decltype(F)>::of(a...);
    gpu_launch(g, ways_of<F, THREADS, AT_ONCE>(), &s, &args);
}

#endif
