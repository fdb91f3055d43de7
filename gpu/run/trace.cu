/* SPDX-License-Identifier: Apache-2.0 */
/* Traces a stage on the device: copies its output to the host for the hash.
 * spec/gpu.md §6 */
#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/base/trace.h"
}

void gpu_trace(struct gpu *g, struct trace *t, const char *stage,
               const void *out, size_t bytes)
{
    if (!t)
        return;
    void *copy = gpu_aside(g, bytes);
    if (copy) {
        gpu_down(g, copy, out, bytes);
        trace_stage(t, stage, copy, bytes);
    }
}
