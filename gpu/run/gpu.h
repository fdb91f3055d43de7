/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of a device to the rest of drape: memory, copies, waits and
 * failures. For C and C++. spec/gpu.md */
#ifndef GPU_GPU_H
#define GPU_GPU_H

#include "names/gpu.h"
#include "ref/base/arena.h"
#include "ref/base/names.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gpu; /* a device, one stream of it, and memory taken there */

/* Opens the device that is current in this thread, with the stream, allocators
 * and block size of def, or the defaults if def is NULL. The caller closes it.
 * *status is DRAPE_OK; or DRAPE_EDEVICE or DRAPE_ENOMEM, and the result NULL.
 */
struct gpu *gpu_open(const drape_def *def, int *status);
void gpu_close(struct gpu *g); /* returns all memory; NULL is allowed */

int gpu_device(const struct gpu *g);   /* CUDA's number; -1: emulated */
void *gpu_stream(const struct gpu *g); /* cudaStream_t */

/* Returns the device in words: name, driver and runtime versions, and the
 * reason if it was lost. Valid until gpu_close. */
const char *gpu_name(const struct gpu *g);

/* Threads of a block, 32 … 256 by 32. No result depends on it. */
void gpu_set_block(struct gpu *g, int threads);

/* How work is done from here on, for tests: no result depends on it. The
 * members after `tight` hold for emulated threads alone. */
struct gpu_way {
    bool hosted;     /* the host ends loops, gpu/run/loop.cuh */
    bool tight;      /* memory grows by no more than it must */
    bool descending; /* blocks run first to last, threads and the blocks of a
                        cluster last to first; else the other way round */
    int shuffled; /* blocks, warps and lanes run in the shuffled order of this
                     number; 0: not */
    int left_out; /* kernels leave out the barrier of this number; 0: none */
    int parted;   /* the barrier of this number synchronises a block only, not
                     its cluster; 0: none */
    int parked;   /* the first of a kernel's blocks waits at the barrier that it
                     comes to as this number, until all other blocks have ended;
                     0: it does not */
    int64_t lost; /* the device is lost with the launch, copy or allocation of
                     this number, until the way is set again; 0: never */
};
/* At most so many blocks in a cluster. */
void gpu_set_ranks(struct gpu *g, int ranks);
void gpu_set_way(struct gpu *g, struct gpu_way way);
void gpu_set_hosted(struct gpu *g); /* the host ends loops from here on */

/* Returns the allocator of device memory that is used if def has none, static.
 */
const drape_allocator *gpu_native(void);

/* Takes zeroed device memory, counted for this part. NULL if there is none:
 * then gpu_status is DRAPE_ENOMEM from there on. */
void *gpu_take(struct gpu *g, enum arena_part part, int64_t count, size_t size);
/* Declares that these bytes, of a block of gpu_take, are free between two
 * solves: gpu_borrow may give them to others meanwhile. */
void gpu_lend(struct gpu *g, void *p, size_t bytes);
/* Memory, not zeroed, for data that need not outlast the next solve of any
 * cloth: lent memory if enough of it is free in one piece, else gpu_take's. */
void *gpu_borrow(struct gpu *g, enum arena_part part, int64_t count,
                 size_t size);
/* Called when a solve begins and when it has ended. The emulation overwrites
 * all lent memory, so that tests find data that should have outlasted the
 * solve. */
void gpu_hand_over(struct gpu *g);
void gpu_give(struct gpu *g, void *p);       /* returns p; NULL is allowed */
const size_t *gpu_held(const struct gpu *g); /* [ARENA_PARTS] bytes now */
void gpu_count(const struct gpu *g, drape_memory *m); /* added to m */

/* Copies to the device, to the host, on the device; zeroes; waits. All are done
 * in the order of the stream; gpu_down and gpu_wait return when it is done. */
void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes);
void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes);
void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes);
void gpu_clear(struct gpu *g, void *device, size_t bytes);
void gpu_wait(struct gpu *g);

/* Returns the first failure since gpu_begin, DRAPE_ENOMEM or DRAPE_EDEVICE, or
 * DRAPE_OK. After a failure nothing is launched or copied. */
int gpu_status(struct gpu *g);
/* A call of the API begins. Memory may be there by now, so DRAPE_ENOMEM is
 * forgotten; a lost device stays lost. CUDA errors of the caller's own calls
 * are forgotten, too. */
void gpu_begin(struct gpu *g);

/* trace_stage of a stream on the device. Waits only if t is not NULL. */
struct trace;
void gpu_trace(struct gpu *g, struct trace *t, const char *stage,
               const void *out, size_t bytes);

/* Seconds that the stream took between these two calls. */
void gpu_clock_start(struct gpu *g);
double gpu_clock_stop(struct gpu *g);

#ifdef __cplusplus
}
#endif
#endif
