/* SPDX-License-Identifier: Apache-2.0 */
/* Scans and sorts: CUB behind two functions. spec/50_gpu.md */
#include "gpu/gpu.cuh"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

void gpu_scan(struct gpu *g, int64_t *a, int64_t n)
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

/* hi, lo, item of a key, as radix sort wants them. */
struct key_parts {
    __host__ __device__ ::cuda::std::tuple<uint64_t &, uint64_t &, int64_t &>
    operator()(struct key &k) const
    {
        return {k.hi, k.lo, k.item};
    }
};

struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare)
{
    size_t bytes = 0;
    if (n < 2 || g->failed)
        return key;
    cub::DoubleBuffer<struct key> keys(key, spare);
    gpu_note(g, cub::DeviceRadixSort::SortKeys(NULL, bytes, keys, n,
                                               key_parts{}, g->stream));
    void *room = gpu_scratch(g, SLOT_SORT, (int64_t)bytes, 1);
    if (room)
        gpu_note(g, cub::DeviceRadixSort::SortKeys(room, bytes, keys, n,
                                                   key_parts{}, g->stream));
    return keys.Current();
}
