/* SPDX-License-Identifier: Apache-2.0 */
/* The device, its primitives and its threads, on the host. */
#include "gpu/gpu.cuh"

#include "certificate.h"

#include <algorithm>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <ucontext.h>

__thread struct emulate_dim blockIdx, threadIdx, gridDim, blockDim;
__thread unsigned char emulate_lane[1024][8];

/* ---- Threads ---- */

/* A thread of a block is a fiber that runs kernel after kernel. It is started
 * with a stack of its own; after that jumps lead from each to the next. They
 * are the compiler's, which keep three words where setjmp keeps registers,
 * encrypted: changing threads is most of what a barrier costs. Stacks whose
 * distance is a power of two would share a few lines of the cache. */
enum { STACK = (1 << 20) + 9 * 64, THREADS = 1024, JUMP = 5 };
static __thread ucontext_t begun;
static __thread void *scheduler[JUMP], *fiber[THREADS][JUMP];
static __thread bool done[THREADS], started[THREADS];
static __thread unsigned in_block, to_run;
static __thread const emulate_call *running; /* NULL: no fibers */
static thread_local struct stacks {
    char *of = NULL; /* the first fiber's */
    ~stacks() { free(of); }
} stack;

void emulate_items(int64_t n, int threads, emulate_call kernel)
{
    int64_t blocks = n > 0 ? (n + threads - 1) / threads : 0;
    gridDim = {(unsigned)blocks, 1, 1};
    blockDim = {(unsigned)threads, 1, 1};
    for (int64_t b = blocks - 1; b >= 0; b--)
        for (int t = 0; t < threads; t++) {
            blockIdx = {(unsigned)b, 0, 0};
            threadIdx = {(unsigned)t, 0, 0};
            kernel.run(kernel.with);
        }
}

static void live(void);

/* Goes on with fiber t, and never returns. */
static __attribute__((noinline)) void resume(unsigned t)
{
    threadIdx = {t, 0, 0};
    if (started[t])
        __builtin_longjmp(fiber[t], 1);
    started[t] = true;
    getcontext(&begun);
    begun.uc_stack.ss_sp = &stack.of[(size_t)t * STACK];
    begun.uc_stack.ss_size = STACK;
    makecontext(&begun, live, 0);
    setcontext(&begun);
}

/* From fiber t to the next that has not returned, in turn; to the scheduler
 * when all have. Returns when fiber t is resumed. */
static __attribute__((noinline)) void leave(unsigned t)
{
    if (__builtin_setjmp(fiber[t]))
        return;
    if (to_run == 0)
        __builtin_longjmp(scheduler, 1);
    do
        t = t + 1 < in_block ? t + 1 : 0;
    while (done[t]);
    resume(t);
}

static void live(void)
{
    for (;;) {
        unsigned t = threadIdx.x;
        running->run(running->with);
        done[t] = true;
        to_run--;
        leave(t);
    }
}

void __syncthreads(void)
{
    if (!running) {
        fputs("emulate: __syncthreads in a kernel of items\n", stderr);
        abort();
    }
    leave(threadIdx.x);
}

/* All threads go on from barrier to barrier until all have returned. */
static __attribute__((noinline)) void run_block(unsigned threads)
{
    memset(done, 0, threads);
    in_block = to_run = threads;
    if (!__builtin_setjmp(scheduler))
        resume(0);
}

void emulate_blocks(int64_t blocks, int threads, emulate_call kernel)
{
    if (!stack.of)
        stack.of = (char *)malloc((size_t)THREADS * STACK);
    gridDim = {(unsigned)(blocks > 0 ? blocks : 0), 1, 1};
    blockDim = {(unsigned)threads, 1, 1};
    running = &kernel;
    for (int64_t b = blocks - 1; b >= 0; b--) {
        blockIdx = {(unsigned)b, 0, 0};
        run_block((unsigned)threads);
    }
    running = NULL;
}

/* ---- The device ---- */

static void *allocate(void *user, size_t bytes)
{
    (void)user;
    return aligned_alloc(64, (bytes + 63) / 64 * 64);
}

static void release(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(p);
}

const drape_allocator *gpu_native(void)
{
    static const drape_allocator native = {allocate, release, NULL};
    return &native;
}

struct gpu *gpu_open(const drape_def *def, int *status)
{
    struct gpu *g = gpu_make(def);
    *status = DRAPE_ENOMEM;
    if (!g)
        return NULL;
    snprintf(g->name, sizeof g->name, "emulated on the host");
    g->stream = def && def->stream ? def->stream : g;
    g->number = -1;
    g->ranks = EMULATE_RANKS;
    g->room = EMULATE_ROOM;
    g->words =
        (int64_t *)gpu_take(g, ARENA_SCRATCH, GPU_WORDS, sizeof *g->words);
    g->seen = (int64_t *)arena_take(&g->host, ARENA_OTHER, GPU_WORDS,
                                    sizeof *g->seen);
    *status = g->seen ? g->failed : DRAPE_ENOMEM;
    if (*status == DRAPE_OK)
        return g;
    gpu_close(g);
    return NULL;
}

void gpu_close(struct gpu *g)
{
    if (g)
        gpu_unmake(g);
}

const char *gpu_info(void)
{
    return WORLD_INFO("emulated on the host");
}

void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes)
{
    gpu_copy(g, device, host, bytes);
}

void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes)
{
    gpu_copy(g, host, device, bytes);
}

void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes)
{
    if (bytes && !g->failed)
        memcpy(to, from, bytes);
}

void gpu_clear(struct gpu *g, void *device, size_t bytes)
{
    if (bytes && !g->failed)
        memset(device, 0, bytes);
}

void gpu_wait(struct gpu *g)
{
    (void)g;
}

int gpu_status(struct gpu *g)
{
    return g->failed;
}

void gpu_begin(struct gpu *g)
{
    if (g->failed == DRAPE_ENOMEM)
        g->failed = DRAPE_OK;
}

void gpu_clock_start(struct gpu *g)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    g->event = (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double gpu_clock_stop(struct gpu *g)
{
    double start = g->event;
    gpu_clock_start(g);
    return g->event - start;
}

int64_t *gpu_words(struct gpu *g)
{
    gpu_clear(g, g->words, GPU_WORDS * sizeof *g->words);
    return g->words;
}

const int64_t *gpu_read_words(struct gpu *g, int n)
{
    gpu_down(g, g->seen, g->words, (size_t)n * sizeof *g->seen);
    if (g->failed)
        memset(g->seen, 0, GPU_WORDS * sizeof *g->seen);
    return g->seen;
}

/* ---- Primitives ---- */

void gpu_scan(struct gpu *g, int64_t *a, int64_t n)
{
    int64_t sum = 0;
    for (int64_t k = 0; k < n && !g->failed; k++) {
        int64_t here = a[k];
        a[k] = sum;
        sum += here;
    }
}

struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare)
{
    (void)spare;
    if (!g->failed)
        std::sort(key, key + n, [](const struct key &a, const struct key &b) {
            if (a.hi != b.hi)
                return a.hi < b.hi;
            return a.lo != b.lo ? a.lo < b.lo : a.item < b.item;
        });
    return key;
}
