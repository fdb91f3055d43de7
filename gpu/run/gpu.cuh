/* SPDX-License-Identifier: Apache-2.0 */
/* What every kernel file includes: the device, launches, and small results.
 * Without nvcc gpu/run/emulate.h stands in for CUDA, so that the same kernels
 * run, one thread after another, on any machine. spec/gpu.md */
#ifndef GPU_GPU_CUH
#define GPU_GPU_CUH

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#ifdef __CUDACC__
#include <cuda_runtime.h>
#else
#include "gpu/run/emulate.h"
#endif

/* ref/'s headers are C's; all of them are included here and only here. */
extern "C" {
#include "gpu/base/stages.h"
#include "gpu/world/world.h"
#include "ref/base/keys.h"
#include "ref/base/sum.h"
#include "ref/cloth/advance.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/implicit.h"
#include "ref/world/checkpoint.h"
#include "ref/world/ending.h"
}

/* Most threads of a block of an item kernel. */
enum { GPU_BLOCK = 256, GPU_WORDS = 32, GPU_LATE = 4, GPU_SLOTS = 8 };
enum { GPU_ALL_WORDS = GPU_WORDS + GPU_LATE };

/* Room that grows and is kept; what a slot held is lost when it does. */
struct gpu_slot {
    void *data;
    size_t bytes;
};

/* A library that is opened at run time lies behind this. */
struct gpu_library {
    void (*close)(struct gpu *g);
};

struct gpu {
#ifdef __CUDACC__
    cudaStream_t stream;
    cudaEvent_t event[2];
    bool lent;               /* the stream is the caller's */
    struct gpu_loops *loops; /* gpu/run/loop.cu; NULL: none yet */
#else
    void *stream;
    double event;
#endif
    int tape; /* TAPE_OFF; with the next it goes with tape.cuh */
    int64_t changes;
    bool tight;       /* gpu_way's */
    bool hosted[2];   /* no loops on the device now, or for good */
    int number;       /* of the device; -1: emulated */
    int block;        /* threads of a block of item kernels */
    int ranks;        /* blocks of a team, gpu/base/team.cuh */
    int crowd;        /* and of a crowd, gpu/base/crowd.cuh */
    const void *team; /* the last kernel that may be a team's */
    int room;         /* bytes of shared memory that a block of one may have */
    bool bulk;        /* the device copies by itself, gpu/base/bulk.cuh */
    int failed;       /* the first failure, or DRAPE_OK */
    char name[320];
    int64_t *words; /* device [GPU_ALL_WORDS] small results of a stage,
                       and of one before it that nobody has read yet */
    int64_t *seen;  /* host, pinned [GPU_ALL_WORDS + 1]: as last read, and a
                       mark */
    bool clean[2];  /* words are 0: the stage's, and the late ones */
    /* the late ones when they were last wiped, and with those since */
    int64_t late[GPU_LATE], late_seen[GPU_LATE];
    struct gpu_slot slot[GPU_SLOTS];
    struct gpu_slot aside;       /* on the host */
    struct gpu_library *library; /* opened by gpu/compare; NULL: none */
    struct arena host;           /* this struct lies in it, too */
    drape_allocator device;      /* of the device's memory */
    struct gpu_block *blocks;    /* all that was taken there */
    size_t bytes[ARENA_PARTS];
    size_t borrowed;
    int64_t taken; /* how often */
};

/* Notes a failure of CUDA's, the first of which stays. */
#ifdef __CUDACC__
void gpu_note(struct gpu *g, cudaError_t error);
/* Lets a kernel be a team's; room: it has team_room(), and no shared memory
 * besides. */
cudaError_t gpu_allow_team(struct gpu *g, const void *kernel, bool room);
#endif

/* ---- Kernels of one thread an item ---- */

/* In a kernel: k is the thread's item of n; threads beyond return. */
#define ITEM(k, n)                                                             \
    int64_t k = (int64_t)blockIdx.x * blockDim.x + threadIdx.x;                \
    if (k >= (n))                                                              \
    return

/* LAUNCH(g, n, kernel, arguments…): a thread for each of n items, which must
 * not synchronise. LAUNCH_BLOCKS: blocks of a fixed number of threads, which
 * may (__syncthreads), all of them. Nothing for n or blocks < 1. */
#ifdef __CUDACC__
#define LAUNCH(g, n, kernel, ...)                                              \
    do {                                                                       \
        int64_t items_ = (n);                                                  \
        unsigned threads_ = (unsigned)(g)->block;                              \
        if (items_ > 0 && !(g)->failed)                                        \
            kernel<<<(unsigned)((items_ + threads_ - 1) / threads_), threads_, \
                     0, (g)->stream>>>(__VA_ARGS__);                           \
    } while (0)
#define LAUNCH_BLOCKS(g, blocks, threads, kernel, ...)                         \
    do {                                                                       \
        int64_t blocks_ = (blocks);                                            \
        if (blocks_ > 0 && !(g)->failed)                                       \
            kernel<<<(unsigned)blocks_, (unsigned)(threads), 0,                \
                     (g)->stream>>>(__VA_ARGS__);                              \
    } while (0)
#else
#define LAUNCH(g, n, kernel, ...)                                              \
    do {                                                                       \
        int64_t items_ = (n);                                                  \
        int threads_ = (g)->block;                                             \
        auto call_ = emulate_bind(kernel, __VA_ARGS__);                        \
        if (items_ > 0 && !(g)->failed)                                        \
            emulate_items(items_, threads_, call_);                            \
    } while (0)
#define LAUNCH_BLOCKS(g, blocks, threads, kernel, ...)                         \
    do {                                                                       \
        int64_t blocks_ = (blocks);                                            \
        int threads_ = (int)(threads);                                         \
        auto call_ = emulate_bind(kernel, __VA_ARGS__);                        \
        if (blocks_ > 0 && !(g)->failed)                                       \
            emulate_blocks(blocks_, threads_, call_);                          \
    } while (0)
#endif

/* Before a short loop: its counter is a constant in each turn. */
#ifdef __CUDACC__
#define UNROLL _Pragma("unroll")
#define UNROLL_8 _Pragma("unroll 8")
#else
#define UNROLL
#define UNROLL_8
#endif

/* ---- Small results: counts, flags, a stage's scalars ---- */

/* g->words, all zero from here on in the stream. */
int64_t *gpu_words(struct gpu *g);
/* g->seen with the first n words, 0 after a failure; waits for the stream, in
 * which they are 0 again behind this. */
const int64_t *gpu_read_words(struct gpu *g, int n);
/* The same, but they stay. */
const int64_t *gpu_look_words(struct gpu *g, int n);
/* Words [GPU_LATE] that another stage's gpu_words lets be, zero from here on:
 * what a stage need not know before the next begins. Any read or look behind it
 * brings them to gpu_late_seen, where they are until the next call. */
int64_t *gpu_late_words(struct gpu *g);
const int64_t *gpu_late_seen(const struct gpu *g);
/* For who reads words: what was seen of the late ones, and are they 0 now? */
void gpu_keep_late(struct gpu *g, bool wiped);

/* ---- Memory, gpu/run/memory.cu ---- */

/* At least count · size bytes of scratch, NULL if there is none. All slots but
 * the solver's are borrowed: what they hold is lost with the next solve. */
void *gpu_scratch(struct gpu *g, int slot, int64_t count, size_t size);
/* The same of the host, of which there is one. */
void *gpu_aside(struct gpu *g, size_t bytes);
/* A struct gpu with all but CUDA's in it, NULL if there is no memory. */
struct gpu *gpu_make(const drape_def *def);
void gpu_unmake(struct gpu *g);

/* ---- Primitives, gpu/run/prim.cu ---- */

/* a[k] = a[0] + … + a[k-1]; the total is a[n-1] after if the last was 0.
 * Whole numbers: no order shows. */
void gpu_scan(struct gpu *g, int64_t *a, int64_t n);
/* Ascending by hi, lo, item, as ref/base/keys.h; both [n]. The sorted keys are
 * in the one returned. */
struct key;
struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare);
/* Slots of scratch that the primitives use; stages use those below. */
enum { SLOT_STAGE = 0, SLOT_SOLVE = 4, SLOT_SORT = 5, SLOT_SCAN = 7 };

#endif
