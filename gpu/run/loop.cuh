/* SPDX-License-Identifier: Apache-2.0 */
/* CUDA graphs of launches that are captured once and kept. A graph may hold a
 * loop that the device ends itself (a WHILE node), so that the host neither
 * launches nor reads back in between. spec/gpu.md §9 */
#ifndef GPU_LOOP_CUH
#define GPU_LOOP_CUH

#include "gpu/run/launch.cuh"

/* A part of a graph: a function that launches kernels in g->stream and does
 * nothing else. It returns DRAPE_OK, or the reason why it did not launch all.
 */
struct loop_part {
    const void *with;
    int (*run)(const void *with);
    loop_part() : with(NULL), run([](const void *) { return (int)DRAPE_OK; }) {}
    template <class F>
    loop_part(const F &f)
        : with(&f), run([](const void *g) { return (*(const F *)g)(); })
    {
    }
};

/* What a graph does: `first`; then `body` while *again, on the device, is not
 * 0, unless again is NULL; then `last`. */
struct loop {
    const int32_t *again;
    loop_part first, body, last;
};

/* Everything that the launches depend on, as plain bytes. A graph that was
 * captured with the same key is launched again, and its parts are not called.
 */
struct loop_key {
    const void *bytes;
    size_t n;
};

/* Queues the graph. False: nothing is queued, because the device has no such
 * graphs, the host is to end loops (gpu_set_hosted), no memory is left for a
 * new graph, or a part did not launch all. */
bool gpu_loop(struct gpu *g, struct loop_key key, const struct loop &of);

#ifdef __CUDACC__
void gpu_loops_close(struct gpu *g);
#endif

#endif
