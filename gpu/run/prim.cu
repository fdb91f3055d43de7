/* SPDX-License-Identifier: Apache-2.0 */
/* Scans and sorts on the device, by CUB. spec/gpu.md */
/* A library neither aborts, as assert does, nor reads the environment, as NVTX
 * does. */
#define NDEBUG
#define CCCL_DISABLE_NVTX
#include "gpu/run/batch.cuh"

extern "C" {
#include "ref/base/keys.h"
}

#include <cub/device/device_merge_sort.cuh>
#include <cub/device/device_scan.cuh>

void gpu_scan_now(struct gpu *g, int64_t *a, int64_t n)
{
    size_t bytes = 0;
    if (n < 1 || g->failed)
        return;
    gpu_note(g, cub::DeviceScan::ExclusiveSum(NULL, bytes, a, a, n, g->stream));
    void *room = gpu_scratch(g, SLOT_SCAN, (int64_t)bytes, 1);
    if (room)
        gpu_note(
            g, cub::DeviceScan::ExclusiveSum(room, bytes, a, a, n, g->stream));
}

/* Compares two keys in the order of ref/base/keys.c. */
struct key_before {
    __device__ bool operator()(const struct key &a, const struct key &b) const
    {
        if (a.hi != b.hi)
            return a.hi < b.hi;
        return a.lo != b.lo ? a.lo < b.lo : a.item < b.item;
    }
};

/* A merge sort: a radix sort of keys of 24 bytes would make 24 passes, and most
 * streams are short. */
struct key *gpu_sort_now(struct gpu *g, int64_t n, struct key *key,
                         struct key *spare)
{
    size_t bytes = 0;
    struct key_before before;
    (void)spare;
    if (n < 1 || g->failed)
        return key;
    gpu_note(g, cub::DeviceMergeSort::SortKeys(NULL, bytes, key, n, before,
                                               g->stream));
    void *room = gpu_scratch(g, SLOT_SORT, (int64_t)bytes, 1);
    if (room)
        gpu_note(g, cub::DeviceMergeSort::SortKeys(room, bytes, key, n, before,
                                                   g->stream));
    return key;
}
