/* SPDX-License-Identifier: Apache-2.0 */
/* Worlds of one device that are advanced together (gpu_batch, gpu/run/gpu.h).
 * The host works for each world as if it were alone, but launches nothing:
 * launches are kept until all worlds wait for the device. Then those that
 * several worlds have to make are made as one, whose block (x, y, z) works for
 * world z. spec/gpu.md §11 */
#ifndef GPU_BATCH_CUH
#define GPU_BATCH_CUH

#include "gpu/run/launch.cuh"

/* Keeps a launch of a world that is in a batch. */
void gpu_batch_keep(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *s, const void *args);
/* Lets other worlds go on, and returns when all launches that this world has
 * kept are made and done. */
void gpu_batch_meet(struct gpu *g);
/* A world begins a step. */
void gpu_batch_step(struct gpu *g);
/* Returns pinned memory of GPU_PINNED bytes for what this world reads back. */
void *gpu_batch_pinned(struct gpu *g);
enum { GPU_PINNED = 4096 };
void gpu_batch_close(struct gpu *g);

/* Copies, zeroes, waits and readbacks of a world that is in no batch, at once.
 */
void gpu_up_now(struct gpu *g, void *device, const void *host, size_t bytes);
void gpu_down_now(struct gpu *g, void *host, const void *device, size_t bytes);
void gpu_copy_now(struct gpu *g, void *to, const void *from, size_t bytes);
void gpu_clear_now(struct gpu *g, void *device, size_t bytes);
void gpu_wait_now(struct gpu *g);
void gpu_scan_now(struct gpu *g, int64_t *a, int64_t n);
struct key *gpu_sort_now(struct gpu *g, int64_t n, struct key *key,
                         struct key *spare);

/* Pinned host memory; NULL and a failure if there is none. gpu_unpin(g, NULL)
 * does nothing. */
void *gpu_pin(struct gpu *g, size_t bytes);
void gpu_unpin(struct gpu *g, void *p);
/* Makes g's device current in this thread. */
void gpu_enter(struct gpu *g);

#endif
