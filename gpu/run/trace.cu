/* SPDX-License-Identifier: Apache-2.0 */
/* The trace of a run on the device. spec/gpu.md §6 */
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
