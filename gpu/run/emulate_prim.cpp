/* SPDX-License-Identifier: Apache-2.0 */
/* Scans and sorts of the emulated device, in place of gpu/run/prim.cu. */
#include "gpu/run/batch.cuh"

extern "C" {
#include "ref/base/keys.h"
}

#include <algorithm>

void gpu_scan_now(struct gpu *g, int64_t *a, int64_t n)
{
    int64_t sum = 0;
    if (g->failed || emulate_lost(true))
        return;
    for (int64_t k = 0; k < n; k++) {
        int64_t here = a[k];
        a[k] = sum;
        sum += here;
    }
}

struct key *gpu_sort_now(struct gpu *g, int64_t n, struct key *key,
                         struct key *spare)
{
    auto before = [](const struct key &a, const struct key &b) {
        if (a.hi != b.hi)
            return a.hi < b.hi;
        return a.lo != b.lo ? a.lo < b.lo : a.item < b.item;
    };
    (void)spare;
    if (!g->failed && !emulate_lost(true))
        std::sort(key, key + n, before);
    return key;
}
