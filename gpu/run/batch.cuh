/* SPDX-License-Identifier: Apache-2.0 */
/* Worlds of one device that are advanced together (gpu_batch, gpu/run/gpu.h).
 * The host works for each world as if it were alone, but launches nothing:
 * launches are kept until all worlds wait for the device. Then those that
 * several worlds have to make are made as one, whose block (x, y, z) works for
 * world z. spec/gpu.md §11 */
#ifndef GPU_BATCH_CUH
#define GPU_BATCH_CUH

#include <pthread.h>
#include <ucontext.h>

#include "gpu/run/launch.cuh"

/* Keeps a launch of a world that is in a batch. */
void gpu_batch_keep(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *s, const void *args);
/* Lets other worlds go on, and returns when all launches that this world has
 * kept are made and done. */
void gpu_batch_meet(struct gpu *g);
/* A world begins a step. */
void gpu_batch_step(struct gpu *g);
/* Returns pinned memory of GPU_PINNED bytes for what a world reads back. */
void *gpu_batch_pinned(struct gpu *g);
enum { GPU_PINNED = 4096 };
/* Releases what a device keeps for batches. */
void gpu_batch_close(struct gpu *g);

/* Copies, zeroes, waits, scans and sorts of a world that is in no batch. */
void gpu_up_now(struct gpu *g, void *device, const void *host, size_t bytes);
void gpu_down_now(struct gpu *g, void *host, const void *device, size_t bytes);
void gpu_copy_now(struct gpu *g, void *to, const void *from, size_t bytes);
void gpu_clear_now(struct gpu *g, void *device, size_t bytes);
void gpu_wait_now(struct gpu *g);
void gpu_scan_now(struct gpu *g, int64_t *a, int64_t n);
struct key *gpu_sort_now(struct gpu *g, int64_t n, struct key *key,
                         struct key *spare);

/* Returns pinned host memory; NULL and a failure if there is none. gpu_unpin
 * takes it back, and NULL. */
void *gpu_pin(struct gpu *g, size_t bytes);
void gpu_unpin(struct gpu *g, void *p);
/* Makes g's device current in this thread. */
void gpu_enter(struct gpu *g);

/* A world's place in a batch. Its device keeps it for the next batch. */
struct gpu_seat {
    struct gpu *g;
    struct batch *batch;
    struct worker *worker;
    ucontext_t here; /* where the host's work for this world waits */
    char *stack;
    bool over, held;       /* held: its launches are not made yet */
    int64_t steps, halt;   /* begun; where it waits, gpu/run/gather.cu */
    struct gpu_seat *next; /* of those that have the same launch to make */
    char *data;            /* launches that are kept, to be made from `at` on */
    size_t used, room, at;
    int count; /* of them */
    void *pinned;
    char *host, *device; /* staging memory of a batch of which this world is the
                            first: pinned, and of the device */
    size_t staging;
    void *stream; /* these three: what g has outside batches */
    int ranks, multiprocessors;
};

/* Where a world can wait, by the launches that follow, and its number in the
 * order in which the first world came there. */
struct halt {
    uint64_t hash;
    int64_t number; /* 0: none */
};
enum { HALTS = 1 << 12, KINDS = 1 << 8 };

struct batch {
    struct gpu_seat **seat; /* [n] */
    int n, workers;
    void (*work)(void *with, int k);
    void *with;

    /* Where workers meet, gpu/run/batch.cu. */
    pthread_mutex_t lock;
    pthread_cond_t change;
    int arrived;
    int64_t generation;
    bool left; /* a world is not over */

    /* How launches become one, gpu/run/gather.cu. */
    struct gpu on; /* the first world's device, without its own failures */
    struct halt halt[HALTS];
    int64_t halts;
    struct kind *kind, *table[KINDS], **waited;
    int kinds, most_kinds, waits;
    struct group *group;
    int groups, most_groups;
    size_t staged; /* bytes of the staging memory */
};

/* Makes the launches of the worlds that are the least far, and waits until they
 * are done. No worker runs. */
void gpu_batch_launch(struct batch *b);

#endif
