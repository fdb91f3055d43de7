/* SPDX-License-Identifier: Apache-2.0 */
/* CUDA graphs of launches that are captured once and kept. A graph runs its
 * launches once, or as a loop that the device ends itself (a WHILE node), so
 * that the host neither launches nor reads back in between. spec/gpu.md §9 */
#ifndef GPU_LOOP_CUH
#define GPU_LOOP_CUH

#include "gpu/run/launch.cuh"

/* One turn of a loop: a function that launches kernels in g->stream and does
 * nothing else. It returns DRAPE_OK, or the reason why it did not launch all.
 */
struct loop_turn {
    const void *with;
    int (*run)(const void *with);
    template <class F>
    loop_turn(const F &f)
        : with(&f), run([](const void *g) { return (*(const F *)g)(); })
    {
    }
};

/* Everything that the launches of a turn depend on, as plain bytes. A graph
 * that was captured with the same key is launched again, and turn is not
 * called. */
struct loop_key {
    const void *bytes;
    size_t n;
};

/* Queues one turn; or, if again is not NULL, turns until *again, on the device,
 * is 0 after one of them. False: nothing is queued, because the device has no
 * such graphs, the host is to end loops (gpu_set_hosted), no memory is left for
 * a new graph, or turn did not launch all. */
bool gpu_loop(struct gpu *g, struct loop_key key, const int32_t *again,
              loop_turn turn);

#ifdef __CUDACC__
void gpu_loops_close(struct gpu *g);
#endif

#endif
