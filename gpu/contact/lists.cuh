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
enum { LIST_SHORT = 64 };
#ifdef __CUDACC__
enum { LIST_BLOCK = 256, LIST_AHEAD = 8, LIST_ROWS = 4 };
#else
enum { LIST_BLOCK = 64, LIST_AHEAD = 3, LIST_ROWS = 2 };
#endif

/* The items of all lists: list.value(at) returns what the item at a place adds
 * to its sum. */

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

/* The same by all lanes of a warp, which must call it with the same arguments;
 * each returns the sum. */
template <class LIST, class T>
static __device__ inline T sum_by_warp(const LIST &list, int32_t from,
                                       int32_t end, T sum)
{
    int lane = (int)threadIdx.x % WARP;
    for (int32_t row = from; row < end; row += LIST_ROWS * WARP) {
        T a[LIST_ROWS];
        UNROLL
        for (int r = 0; r < LIST_ROWS; r++) {
            int32_t at = row + r * WARP + lane;
            a[r] = list.value(at < end ? at : from);
        }
        UNROLL
        for (int r = 0; r < LIST_ROWS; r++) {
            int left = end - row - r * WARP;
            UNROLL_8
            for (int k = 0; k < WARP; k++) {
                T next = lane_value(a[r], k);
                sum = k < left ? list_add(sum, next) : sum;
            }
        }
    }
    return sum;
}

/* Sums list i, unless i < 0: from list.first(i) on; then list.done(i, sum) is
 * called. All threads of a block of LIST_BLOCK must call it. */
template <class LIST>
static __device__ inline void sum_list(const LIST &list, int64_t i)
{
    __shared__ int32_t longer[LIST_BLOCK];
    __shared__ int n;
    if (threadIdx.x == 0)
        n = 0;
    __syncthreads();
    int32_t from = i < 0 ? 0 : list.start[i],
            end = i < 0 ? 0 : list.start[i + 1];
    if (end - from > LIST_SHORT)
        longer[atomicAdd(&n, 1)] = (int32_t)i;
    else if (i >= 0)
        list.done(i, sum_by_thread(list, from, end, list.first(i)));
    __syncthreads();
    for (int k = (int)threadIdx.x / WARP; k < n; k += LIST_BLOCK / WARP) {
        int32_t of = longer[k];
        auto sum = sum_by_warp(list, list.start[of], list.start[of + 1],
                               list.first(of));
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
    LAUNCH_BLOCKS(g, ((n) + LIST_BLOCK - 1) / LIST_BLOCK, LIST_BLOCK, kernel,  \
                  __VA_ARGS__)

#endif
