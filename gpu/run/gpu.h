/* SPDX-License-Identifier: Apache-2.0 */
/* A device as the rest of drape sees it: memory, copies, and every stage as
 * gpu_X beside ref_X. C and C++. spec/gpu.md */
#ifndef GPU_GPU_H
#define GPU_GPU_H

#include "gpu/base/names.h"
#include "ref/base/arena.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gpu; /* a device, one stream of it, and what was taken there */

/* The device that is current in this thread, with def's stream, allocators and
 * block; def NULL: the defaults. *status: DRAPE_OK, DRAPE_EDEVICE or
 * DRAPE_ENOMEM, and then NULL. The caller closes it. */
struct gpu *gpu_open(const drape_def *def, int *status);
void gpu_close(struct gpu *g); /* gives back all memory; NULL is allowed */

int gpu_device(const struct gpu *g);   /* CUDA's number; -1: emulated */
void *gpu_stream(const struct gpu *g); /* cudaStream_t */

/* The device in words: name, driver, runtime, and why it was lost if it was;
 * valid until gpu_close. */
const char *gpu_name(const struct gpu *g);

/* Threads of a block, 32 … 256 by 32. No result depends on it. */
void gpu_set_block(struct gpu *g, int threads);

/* For tests, as no result depends on them: the ranks of a team, where it can
 * have as many, and how work is done from here on. What follows `tight` holds
 * for emulated threads alone. */
struct gpu_way {
    bool hosted;     /* the host ends loops, gpu/run/loop.cuh */
    bool tight;      /* memory grows by no more than it must */
    bool descending; /* blocks first to last, threads and ranks last to first */
    int shuffled;    /* blocks, ranks, warps and threads of a warp in an order
                        of their own, of which there are many; 0: not */
    int left_out;    /* kernels go on without this barrier of theirs; 0: none */
    int parted;      /* where this one is the team's, it is the rank's */
    int64_t lost;    /* the launch, copy or allocation from here on with which
                        the device is lost, to be back with the next way; 0:
                        none */
};
void gpu_set_ranks(struct gpu *g, int ranks);
void gpu_set_way(struct gpu *g, struct gpu_way way);
void gpu_set_hosted(struct gpu *g); /* for good */

/* The allocator of a device's memory where def has none; static. */
const drape_allocator *gpu_native(void);

/* Zeroed device memory of a part, NULL if there is none: then gpu_status says
 * DRAPE_ENOMEM from there on. */
void *gpu_take(struct gpu *g, enum arena_part part, int64_t count, size_t size);
/* The bytes from p on, of a block of gpu_take's, hold nothing between two
 * solves: gpu_borrow may give them to others meanwhile. */
void gpu_lend(struct gpu *g, void *p, size_t bytes);
/* Memory for what need not outlast the next solve, of any cloth: lent, where
 * enough of that is free in one piece, else gpu_take's. It holds anything. */
void *gpu_borrow(struct gpu *g, enum arena_part part, int64_t count,
                 size_t size);
/* A solve begins, or has ended: emulated, all that is lent is spoiled, so that
 * what should have outlasted it shows. */
void gpu_hand_over(struct gpu *g);
void gpu_give(struct gpu *g, void *p);       /* back; NULL is allowed */
const size_t *gpu_held(const struct gpu *g); /* [ARENA_PARTS] bytes now */
void gpu_count(const struct gpu *g, drape_memory *m); /* added to m */

/* In the order of the stream; gpu_down and gpu_wait end when it is done. */
void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes);
void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes);
void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes);
void gpu_clear(struct gpu *g, void *device, size_t bytes);
void gpu_wait(struct gpu *g);

/* The first failure since gpu_begin: DRAPE_OK, DRAPE_ENOMEM, DRAPE_EDEVICE.
 * After one nothing is launched or copied. */
int gpu_status(struct gpu *g);
/* A call of the API begins: room may have come since the last, but a lost
 * device stays lost; errors of the caller's own calls are not counted. */
void gpu_begin(struct gpu *g);

/* Seconds that the stream took between the two calls. */
void gpu_clock_start(struct gpu *g);
double gpu_clock_stop(struct gpu *g);

#ifdef __cplusplus
}
#endif
#endif
