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

/* How the device does its work from here on. Tests change it, as no result may
 * depend on it. The members after `tight` matter to emulated devices only. */
struct gpu_way {
    bool hosted;     /* the host ends loops, gpu/run/loop.cuh */
    bool tight;      /* memory grows by no more than it must */
    bool descending; /* blocks run first to last, threads and the blocks of a
                        cluster last to first; else the other way round */
    int shuffled;    /* not 0: the seed of the shuffled order in which blocks,
                        warps and lanes run; 0: `descending` says the order */
    int left_out; /* kernels skip the barrier that has this number; 0: none */
    int parted;   /* the barrier that has this number synchronises each block by
                     itself and not the whole cluster; 0: none */
    int parked;   /* the first block of a kernel waits at the barrier that is
                     this number on its way, until all other blocks have ended;
                     0: it does not wait */
    int64_t lost; /* the device is lost at the launch, copy or allocation that
                     has this number, until the way is set again; 0: never */
};
/* At most so many blocks in a cluster. */
void gpu_set_ranks(struct gpu *g, int ranks);
void gpu_set_way(struct gpu *g, struct gpu_way way);
void gpu_set_hosted(struct gpu *g); /* the host ends loops from here on */

/* Returns the allocator of device memory that is used if def has none, static.
 */
const drape_allocator *gpu_native(void);

/* Takes zeroed device memory, which is counted for this part. Returns NULL if
 * there is no memory; gpu_status is then DRAPE_ENOMEM. */
void *gpu_take(struct gpu *g, enum arena_part part, int64_t count, size_t size);
/* The capacity, in items, of memory that has become too small and has to hold
 * `need`: a quarter more, and more than twice as much of few items. */
int64_t gpu_capacity(const struct gpu *g, int64_t need);
/* Takes device memory for a stream and copies the host's stream to it, or
 * leaves it zero if host is NULL. Returns NULL if there is no memory. */
void *gpu_take_copy(struct gpu *g, enum arena_part part, const void *host,
                    int64_t count, size_t size);
/* The same for a pointer p: sets p to a stream of count items of its type. */
#define GPU_TAKE_COPY(g, p, part, host, count)                                 \
    (p) = (decltype(p))gpu_take_copy(g, part, host, count, sizeof *(p))
/* Lends bytes of a block of gpu_take: their owner does not need them between
 * two solves, so gpu_borrow may give them to others meanwhile. */
void gpu_lend(struct gpu *g, void *p, size_t bytes);
/* Returns memory, not zeroed, for data that need not outlast the next solve of
 * any cloth. It is lent memory if enough of that is free in one piece, else
 * memory of gpu_take. */
void *gpu_borrow(struct gpu *g, enum arena_part part, int64_t count,
                 size_t size);
/* Called when a solve begins and when it has ended. The emulation then
 * overwrites all lent memory, so that a test fails where a stage relies on data
 * that a solve may destroy. */
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

/* Returns scratch of at least so many bytes in host memory, or NULL if there is
 * no memory. The next call may return the same memory. */
void *gpu_aside(struct gpu *g, size_t bytes);

/* trace_stage of a stream on the device. Waits only if t is not NULL. */
struct trace;
void gpu_trace(struct gpu *g, struct trace *t, const char *stage,
               const void *out, size_t bytes);

/* Calls work(with, k) for each of n worlds, whose devices are g [n], and makes
 * the launches of all of them together, with `threads` threads of the host ≥ 1.
 * No device is listed twice, all have one number, and no work uses another
 * one's. Returns DRAPE_OK, or DRAPE_ENOMEM if nothing was done.
 * gpu/run/batch.cuh */
int gpu_batch(struct gpu *const *g, int n, int threads,
              void (*work)(void *with, int k), void *with);

/* Every stage X on the device: gpu_X takes the struct X of ref_X, whose streams
 * are in device memory. The struct itself is in host memory. */
#define STAGE(room, file, X, rule)                                             \
    struct X;                                                                  \
    int gpu_##X(struct gpu *g, struct X *s);
#include "spec/stages.def"
#undef STAGE

/* Seconds that the stream took between these two calls. */
void gpu_clock_start(struct gpu *g);
double gpu_clock_stop(struct gpu *g);

#ifdef __cplusplus
}
#endif
#endif
