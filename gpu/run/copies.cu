/* SPDX-License-Identifier: Apache-2.0 */
/* Copies, zeroes, waits, scans and sorts, for real and emulated devices: at
 * once, or, of a world that is in a batch, by kernels that can be kept.
 * gpu/run/batch.cuh */
#include "gpu/run/batch.cuh"

extern "C" {
#include "ref/base/keys.h"
}

/* What a kernel moves: a thread moves CHUNK bytes. PIECE: bytes that a launch
 * takes with it as an argument; UP_MOST: bytes that are copied so. */
enum { CHUNK = 16, PIECE = 256, UP_MOST = 4096 };
/* The most items that a kernel of a batch scans or sorts. */
enum { SCAN_MOST = 1 << 16, SORT_MOST = 1 << 13 };
enum { SCAN_BLOCK = 256, SCAN_EACH = 8 };

struct piece {
    unsigned char data[PIECE];
};

static __device__ inline bool even(const void *p)
{
    return (uintptr_t)p % CHUNK == 0;
}

struct chunk {
    uint64_t word[2];
};

/* Where chunk k of so many bytes ends. */
static __device__ inline int64_t end_of(int64_t k, int64_t bytes)
{
    return (k + 1) * CHUNK < bytes ? (k + 1) * CHUNK : bytes;
}

/* Thread k copies chunk k. */
KERNEL copy_kernel(unsigned char *to, const unsigned char *from, int64_t bytes)
{
    ITEM(k, (bytes + CHUNK - 1) / CHUNK);
    int64_t end = end_of(k, bytes);
    if (end == (k + 1) * CHUNK && even(to) && even(from))
        ((struct chunk *)to)[k] = ((const struct chunk *)from)[k];
    else
        for (int64_t b = k * CHUNK; b < end; b++)
            to[b] = from[b];
}

/* Thread k zeroes chunk k. */
KERNEL clear_kernel(unsigned char *to, int64_t bytes)
{
    ITEM(k, (bytes + CHUNK - 1) / CHUNK);
    int64_t end = end_of(k, bytes);
    if (end == (k + 1) * CHUNK && even(to))
        ((struct chunk *)to)[k] = {};
    else
        for (int64_t b = k * CHUNK; b < end; b++)
            to[b] = 0;
}

/* Thread k writes byte k. */
KERNEL write_kernel(unsigned char *to, int64_t bytes, const struct piece &p)
{
    ITEM(k, bytes);
    to[k] = p.data[k];
}

void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes)
{
    if (!g->together)
        gpu_copy_now(g, to, from, bytes);
    else
        LAUNCH(g, ((int64_t)bytes + CHUNK - 1) / CHUNK, copy_kernel,
               (unsigned char *)to, (const unsigned char *)from,
               (int64_t)bytes);
}

void gpu_clear(struct gpu *g, void *device, size_t bytes)
{
    if (!g->together)
        gpu_clear_now(g, device, bytes);
    else
        LAUNCH(g, ((int64_t)bytes + CHUNK - 1) / CHUNK, clear_kernel,
               (unsigned char *)device, (int64_t)bytes);
}

void gpu_wait(struct gpu *g)
{
    if (!g->together)
        gpu_wait_now(g);
    else
        gpu_batch_meet(g);
}

void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes)
{
    unsigned char *to = (unsigned char *)device;
    const unsigned char *from = (const unsigned char *)host;
    if (!g->together || bytes > UP_MOST) {
        if (g->together)
            gpu_batch_meet(g);
        gpu_up_now(g, device, host, bytes);
        return;
    }
    for (size_t b = 0; b < bytes; b += PIECE) {
        struct piece p = {};
        int64_t n = bytes - b < PIECE ? (int64_t)(bytes - b) : (int64_t)PIECE;
        memcpy(p.data, from + b, (size_t)n);
        LAUNCH(g, n, write_kernel, to + b, n, p);
    }
}

void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes)
{
    void *pinned =
        g->together && bytes <= GPU_PINNED ? gpu_batch_pinned(g) : NULL;
    if (pinned)
        gpu_copy(g, pinned, device, bytes);
    if (g->together)
        gpu_batch_meet(g);
    if (!pinned)
        gpu_down_now(g, host, device, bytes);
    else if (!g->failed)
        memcpy(host, pinned, bytes);
}

/* One block scans a [n]: each thread sums SCAN_EACH items, and the sums of the
 * threads are scanned by doubling strides. */
KERNEL scan_kernel(int64_t *a, int64_t n)
{
    __shared__ int64_t sum[SCAN_BLOCK];
    int t = (int)threadIdx.x;
    int64_t base = 0;
    for (int64_t first = 0; first < n; first += SCAN_EACH * SCAN_BLOCK) {
        int64_t from = first + SCAN_EACH * (int64_t)t, all = 0;
        int64_t end = from + SCAN_EACH < n ? from + SCAN_EACH : n;
        for (int64_t k = from; k < end; k++)
            all += a[k];
        sum[t] = all;
        __syncthreads();
        for (int apart = 1; apart < SCAN_BLOCK; apart *= 2) {
            int64_t before = t >= apart ? sum[t - apart] : 0;
            __syncthreads();
            sum[t] += before;
            __syncthreads();
        }
        int64_t place = base + sum[t] - all;
        for (int64_t k = from; k < end; k++) {
            int64_t here = a[k];
            a[k] = place;
            place += here;
        }
        base += sum[SCAN_BLOCK - 1];
        __syncthreads(); /* sum is written again */
    }
}

void gpu_scan(struct gpu *g, int64_t *a, int64_t n)
{
    if (g->together && n <= SCAN_MOST) {
        LAUNCH_BLOCKS(g, n > 0, SCAN_BLOCK, scan_kernel, a, n);
        return;
    }
    if (g->together)
        gpu_batch_meet(g);
    gpu_scan_now(g, a, n);
}

/* Whether key a comes before key b, as in ref/base/keys.c. */
static __device__ inline bool before(const struct key &a, const struct key &b)
{
    if (a.hi != b.hi)
        return a.hi < b.hi;
    return a.lo != b.lo ? a.lo < b.lo : a.item < b.item;
}

/* Thread k writes key k to its place, which is the number of keys before it; of
 * equal keys the first comes first. */
KERNEL rank_kernel(const struct key *key, int64_t n, struct key *to)
{
    ITEM(k, n);
    struct key mine = key[k];
    int64_t place = 0;
    for (int64_t o = 0; o < n; o++)
        place += o < k ? !before(mine, key[o]) : before(key[o], mine);
    to[place] = mine;
}

struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare)
{
    if (g->together && n <= SORT_MOST) {
        struct key *to = (struct key *)gpu_scratch(g, SLOT_SORT, n, sizeof *to);
        LAUNCH(g, to ? n : 0, rank_kernel, key, n, to);
        gpu_copy(g, key, to, to ? (size_t)n * sizeof *to : 0);
        return key;
    }
    if (g->together)
        gpu_batch_meet(g);
    return gpu_sort_now(g, n, key, spare);
}
