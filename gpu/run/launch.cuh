/* SPDX-License-Identifier: Apache-2.0 */
/* Every file of kernels includes this header: it has the device, launches,
 * readbacks and memory. Without nvcc gpu/run/emulate.h stands in for CUDA, so
 * that the same kernels run on any machine, one thread after another.
 * spec/gpu.md */
#ifndef GPU_LAUNCH_CUH
#define GPU_LAUNCH_CUH

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

/* The headers of ref/ are C. gpu/ includes them within extern "C", after this
 * file, which has included the system's headers that they need. */
extern "C" {
#include "gpu/run/gpu.h"
#include "ref/base/real.h"
}

/* GPU_BLOCK: the largest number of threads in a block of an item kernel.
 * GPU_WORDS: the words of a stage's small results. GPU_LATE: the words that may
 * be read back later. GPU_SLOTS: the slots of scratch. */
enum { GPU_BLOCK = 256, GPU_WORDS = 32, GPU_LATE = 4, GPU_SLOTS = 8 };
enum { GPU_ALL_WORDS = GPU_WORDS + GPU_LATE };
/* GPU_SIDES: branches that may run beside each other. */
enum { GPU_SIDES = 8 };

/* Scratch memory that is kept and can grow. Growing loses its contents. */
struct gpu_slot {
    void *data;
    size_t bytes;
};

/* The first member of the struct of a library that is opened at run time, such
 * as cuBLAS in gpu/compare. */
struct gpu_library {
    void (*close)(struct gpu *g);
};

struct gpu {
#ifdef __CUDACC__
    cudaStream_t stream;
    cudaEvent_t event[2];
    cudaStream_t main, side[GPU_SIDES]; /* gpu_fork; side: opened when used */
    cudaEvent_t forked, done[GPU_SIDES];
    unsigned used;           /* bit k: branch k has launches since the fork */
    bool lent;               /* the stream is the caller's */
    struct gpu_loops *loops; /* gpu/run/loop.cu; NULL: none yet */
#else
    void *stream;
    double event;
#endif
    bool tight;     /* memory grows by no more than it must, gpu_way */
    bool hosted[2]; /* the host ends loops: as gpu_way says, and for good */
    int number;     /* CUDA's number of the device; -1: emulated */
    int block;      /* threads of a block of item kernels */
    int ranks;      /* blocks of a thread-block cluster, 1: no clusters */
    int multiprocessors; /* multiprocessors, for cooperative launches */
    const void
        *cluster_kernel; /* the last kernel that was allowed to be a cluster */
    int room;            /* bytes of shared memory that a block may have */
    bool bulk;           /* the device has bulk copies, gpu/base/bulk.cuh */
    int failed;          /* the first failure, or DRAPE_OK */
    char name[320];
    int64_t *words; /* device [GPU_ALL_WORDS] small results of this stage, then
                       the late words of earlier stages */
    int64_t *seen;  /* host, pinned [GPU_ALL_WORDS + 1] the words at the last
                       readback, then a mark */
    bool clean[2];  /* whether the stage's words, and the late words, are 0 */
    /* Values of the late words. late: what a readback has brought and cleared
     * on the device since gpu_late_words; late_seen: with what was on the
     * device at the last readback, which is what gpu_late_seen returns. */
    int64_t late[GPU_LATE], late_seen[GPU_LATE];
    struct gpu_slot slot[GPU_SLOTS];
    struct gpu_slot aside;       /* scratch in host memory */
    struct gpu_library *library; /* opened by gpu/compare; NULL: none */
    struct gpu_merge *merge;     /* gpu/run/merge.cuh; NULL: not open */
    struct gpu_seat *seat;       /* gpu/run/batch.cuh; NULL: never in one */
    bool together;               /* in a batch: launches are kept */
    struct arena host;           /* all host memory, with that of this struct */
    drape_allocator device;      /* of device memory */
    struct gpu_block *blocks;    /* all blocks of device memory */
    size_t bytes[ARENA_PARTS];   /* device memory held now, by part */
    size_t borrowed;             /* bytes that are borrowed now */
    int64_t taken;               /* allocations so far */
};

/* Records a failure of CUDA; the first one stays. */
#ifdef __CUDACC__
void gpu_note(struct gpu *g, cudaError_t error);
void gpu_branches_close(struct gpu *g);
/* Allows a kernel to be launched as a cluster. room: it uses cluster_shared(),
 * and no other shared memory. */
cudaError_t gpu_allow_cluster(struct gpu *g, const void *kernel, bool room);
#endif

/* In a kernel: k is the item of this thread, of n items; threads without an
 * item return. */
#define ITEM(k, n)                                                             \
    int64_t k = (int64_t)blockIdx.x * blockDim.x + threadIdx.x;                \
    if (k >= (n))                                                              \
    return

/* KERNEL begins the definition of a kernel: a function that takes each argument
 * as a value or a const reference.
 * LAUNCH(g, n, kernel, arguments…) runs one thread for each of n items; the
 * threads must not synchronise. LAUNCH_BLOCKS runs blocks of a fixed number of
 * threads, which may synchronise; LAUNCH_AT_ONCE does so with at least at_once
 * blocks on a multiprocessor. None does anything for n or blocks < 1.
 * LAUNCH_PARTS is as LAUNCH_AT_ONCE for kernels that do not ask for gridDim:
 * launches of several worlds can be one although their blocks are not as many.
 * A kernel of items must bear more blocks than its items need. */
#ifdef __CUDACC__
#define KERNEL static __device__ __forceinline__ void
#else
#define KERNEL static void
#endif
#define LAUNCH(g, n, kernel, ...)                                              \
    launch_kernel<&kernel, GPU_BLOCK, 1>(g, shape_of_items(g, n), __VA_ARGS__)
#define LAUNCH_BLOCKS(g, blocks, threads, kernel, ...)                         \
    LAUNCH_AT_ONCE(g, blocks, threads, 1, kernel, __VA_ARGS__)
#define LAUNCH_PARTS(g, blocks, threads, at_once, kernel, ...)                 \
    launch_kernel<&kernel, (threads), (at_once)>(                              \
        g, shape_of_parts(blocks, threads), __VA_ARGS__)
#define LAUNCH_AT_ONCE(g, blocks, threads, at_once, kernel, ...)               \
    launch_kernel<&kernel, (threads), (at_once)>(                              \
        g, shape_of_blocks(blocks, threads), __VA_ARGS__)

/* UNROLL stands before a short loop and makes the compiler unroll it, so that
 * the counter is a constant in each iteration. UNROLL_IF does so if a constant
 * is true, and else makes the compiler leave the loop. */
#ifdef __CUDACC__
#define UNROLL _Pragma("unroll")
#define UNROLL_IF(constant) UNROLL_BY(unroll((constant) ? 32 : 1))
#define UNROLL_BY(words) _Pragma(#words)
#define UNROLL_8 _Pragma("unroll 8")
#else
#define UNROLL
#define UNROLL_IF(constant)
#define UNROLL_8
#endif

/* Launches of different branches may run beside each other. gpu_fork: branches
 * begin after what was launched before. gpu_branch: the launches that follow
 * belong to branch k ≥ 0. gpu_join: what follows waits for all branches. A
 * scratch slot must not be used by two branches. */
void gpu_fork(struct gpu *g);
void gpu_branch(struct gpu *g, int k);
void gpu_join(struct gpu *g);

/* Returns g->words, which are zero for the kernels that are launched next. */
int64_t *gpu_words(struct gpu *g);
/* Reads back the first n words, or zeros after a failure. The host waits for
 * the stream. The words on the device are zero afterwards. */
const int64_t *gpu_read_back(struct gpu *g, int n);
/* The same, but the words on the device stay as they are. */
const int64_t *gpu_read_back_keep(struct gpu *g, int n);
/* Returns words [GPU_LATE], zero at first, for results that the host need not
 * know before the next stage begins. gpu_words of later stages does not clear
 * them. The next readback of any stage brings them to gpu_late_seen, which
 * returns them until the next call of gpu_late_words. */
int64_t *gpu_late_words(struct gpu *g);
const int64_t *gpu_late_seen(const struct gpu *g);
/* The readback itself: waits for the stream and writes g->seen, or sets
 * g->failed. clear: the words on the device are zero afterwards. Must not be
 * called after a failure. */
void gpu_read_back_now(struct gpu *g, bool clear);

/* Returns at least count · size bytes of scratch, or NULL if there is no
 * memory. All slots but SLOT_SOLVE are borrowed: the next solve overwrites
 * them. */
void *gpu_scratch(struct gpu *g, int slot, int64_t count, size_t size);
/* Returns a struct gpu in which only CUDA's members are missing; NULL if there
 * is no memory. native: the allocator of device memory if def has none. */
struct gpu *gpu_make(const drape_def *def, const drape_allocator *native);
void gpu_unmake(struct gpu *g);

/* Exclusive scan: a[k] becomes a[0] + … + a[k-1]. If the last item was 0,
 * a[n-1] is the total afterwards. Sums of integers do not
 * depend on the order. */
void gpu_scan(struct gpu *g, int64_t *a, int64_t n);
/* Sorts n keys, ascending by hi, lo, item (ref/base/keys.h). Returns key or
 * spare, whichever has the sorted keys. */
struct key;
struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare);
/* Slots of scratch: stages use those from SLOT_STAGE on, the solver and the
 * primitives those named after them. */
enum { SLOT_STAGE = 0, SLOT_SOLVE = 4, SLOT_SORT = 5, SLOT_SCAN = 7 };

#include "gpu/run/kernel.cuh"

#endif
