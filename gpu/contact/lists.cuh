/* SPDX-License-Identifier: Apache-2.0 */
/* Sums over the items of a vertex, in the order of its list: a thread sums a
 * short list, a warp a long one. A vertex of cloth at the pole of a sphere may
 * have a thousand contacts, and one thread would wait for memory after every
 * few of them. The additions are the same ones in the same order either way.
 * spec/contact/contacts.md §1 */
#ifndef GPU_LISTS_CUH
#define GPU_LISTS_CUH

#include "gpu/base/cluster.cuh"

/* LIST_BLOCK: threads of a block that calls sum_list. LIST_SHORT: the most
 * items of a list that a thread sums. LIST_AHEAD, LIST_ROWS: items that a
 * thread, and a lane, load before the first is added, so that latencies
 * overlap. */
enum { LIST_SHORT = 32, LIST_BLOCK = 256 };
#ifdef __CUDACC__
enum { LIST_AHEAD = 8, LIST_ROWS = 8 };
#else
enum { LIST_AHEAD = 3, LIST_ROWS = 2 };
#endif

/* The items of all lists: list i has places [list.start[i], list.end(i)), and
 * list.value(at) returns what the item at a place adds to its sum. */

static __device__ inline vec list_add(vec sum, vec value)
{
    return add(sum, value);
}

static __device__ inline real list_add(real sum, real value)
{
    return sum + value;
}

static __device__ inline int32_t list_add(int32_t sum, int32_t value)
{
    return sum + value;
}

/* Adds the items at places [from, end) to sum. */
template <class LIST, class T>
static __device__ inline T sum_by_thread(const LIST &list, int32_t from,
                                         int32_t end, T sum)
{
    for (int32_t at = from; at < end; at += LIST_AHEAD) {
        T a[LIST_AHEAD];
        UNROLL
        for (int k = 0; k < LIST_AHEAD; k++)
            a[k] = list.value(at + k < end ? at + k : at);
        UNROLL
        for (int k = 0; k < LIST_AHEAD; k++)
            if (at + k < end)
                sum = list_add(sum, a[k]);
    }
    return sum;
}

/* The numbers of which an item consists. */
static __device__ inline real *numbers(vec *a)
{
    return &a->x;
}

template <class N> static __device__ inline N *numbers(N *a)
{
    return a;
}

/* Loads the items of a lane in the rows from `from` on. */
template <class LIST, class T>
static __device__ inline void load_rows(const LIST &list, int32_t from,
                                        int32_t end, int lane, T row[LIST_ROWS])
{
    UNROLL
    for (int r = 0; r < LIST_ROWS; r++) {
        int32_t at = from + r * WARP + lane;
        if (at < end)
            row[r] = list.value(at);
    }
}

/* The same by all lanes of a warp, which must call it with the same arguments;
 * each returns the sum. Rows are loaded while those before are added. The lanes
 * put a row of items into shared memory,
 * [WARP], and a lane for each number of an item adds them. */
template <class LIST, class T>
static __device__ inline T sum_by_warp(const LIST &list, int32_t from,
                                       int32_t end, T sum, T *row)
{
    auto *number = numbers(row), *own = numbers(&sum);
    enum { NUMBERS = sizeof(T) / sizeof *own };
    int lane = (int)threadIdx.x % WARP, e = lane % NUMBERS;
    auto s = own[0];
    UNROLL
    for (int k = 1; k < NUMBERS; k++)
        s = e == k ? own[k] : s;
    T next[LIST_ROWS] = {};
    load_rows(list, from, end, lane, next);
    for (; from < end; from += LIST_ROWS * WARP) {
        T a[LIST_ROWS];
        UNROLL
        for (int r = 0; r < LIST_ROWS; r++)
            a[r] = next[r];
        load_rows(list, from + LIST_ROWS * WARP, end, lane, next);
        UNROLL
        for (int r = 0; r < LIST_ROWS; r++) {
            __syncwarp();
            row[lane] = a[r];
            __syncwarp();
            int n = min_of(end - from - r * (int)WARP, (int32_t)WARP);
            UNROLL_8
            for (int k = 0; k < n; k++)
                s += number[NUMBERS * k + e];
        }
    }
    __syncwarp(); /* the row may be written again */
    UNROLL
    for (int k = 0; k < NUMBERS; k++)
        own[k] = lane_value(s, k);
    return sum;
}

/* Sums list i, unless i < 0: from list.first(i) on; then list.done(i, sum) is
 * called. All threads of a block of LIST_BLOCK must call it. */
template <class LIST>
static __device__ inline void sum_list(const LIST &list, int64_t i)
{
    typedef decltype(list.first(i)) item;
    __shared__ int32_t longer[LIST_BLOCK];
    __shared__ item row[LIST_BLOCK / WARP][WARP];
    __shared__ int n;
    int warp = (int)threadIdx.x / WARP;
    if (threadIdx.x == 0)
        n = 0;
    __syncthreads();
    int32_t from = i < 0 ? 0 : list.start[i], end = i < 0 ? 0 : list.end(i);
    if (end - from > LIST_SHORT)
        longer[atomicAdd(&n, 1)] = (int32_t)i;
    else if (i >= 0)
        list.done(i, sum_by_thread(list, from, end, list.first(i)));
    __syncthreads();
    for (int k = warp; k < n; k += LIST_BLOCK / WARP) {
        int32_t of = longer[k];
        auto sum = sum_by_warp(list, list.start[of], list.end(of),
                               list.first(of), row[warp]);
        if (threadIdx.x % WARP == 0)
            list.done(of, sum);
    }
}

/* The list of a thread of LIST_BLOCK, of n lists; -1 beyond them. */
static __device__ inline int64_t own_list(int64_t n)
{
    int64_t i = (int64_t)blockIdx.x * LIST_BLOCK + threadIdx.x;
    return i < n ? i : -1;
}

/* Launches a kernel that sums n lists, a thread each, with sum_list. */
#define LAUNCH_LISTS(g, n, kernel, ...)                                        \
    LAUNCH_PARTS(g, ((n) + LIST_BLOCK - 1) / LIST_BLOCK, LIST_BLOCK, 1,        \
                 kernel, __VA_ARGS__)

#endif
