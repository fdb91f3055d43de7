/* SPDX-License-Identifier: Apache-2.0 */
/* Launches that are queued once and kept, as one or as a loop that the device
 * ends, so that the host neither launches nor looks between them.
 * spec/gpu.md §9 */
#ifndef GPU_LOOP_CUH
#define GPU_LOOP_CUH

#include "gpu/run/gpu.cuh"

/* A turn: launches in g->stream, and nothing else. It returns DRAPE_OK, or why
 * it did not queue them all. */
struct loop_turn {
    const void *with;
    int (*run)(const void *with);
    template <class F>
    loop_turn(const F &f)
        : with(&f), run([](const void *g) { return (*(const F *)g)(); })
    {
    }
};

/* All that the launches of a turn depend on, as plain bytes: with the same key
 * what was queued once runs again, and turn is not called. */
struct loop_key {
    const void *bytes;
    size_t n;
};

/* Queues one turn, or more until *again, on the device, is 0 after one, where
 * that is not NULL. false: nothing is queued, as this device has no such
 * loops, or is not to, or has no room for one more, or the turn is not whole.
 */
bool gpu_loop(struct gpu *g, struct loop_key key, const int32_t *again,
              loop_turn turn);

#ifdef __CUDACC__
void gpu_loops_close(struct gpu *g);
#endif

#endif
