/* SPDX-License-Identifier: Apache-2.0 */
/* A device's threads on the host. gpu/emulate.h */
#include "gpu/reel.cuh"

#include <stdio.h>
#include <stdlib.h>
#include <ucontext.h>
#include <vector>

__thread struct emulate_dim blockIdx, threadIdx, gridDim, blockDim;
__thread unsigned char emulate_lane[1024][32];
__thread int emulate_ranks;

static __thread struct gpu_way way;
static __thread int64_t asked; /* of the device, since its way was set */

void gpu_set_way(struct gpu *g, struct gpu_way to)
{
    g->hosted[0] = to.hosted;
    g->falters = to.falters;
    g->tight = to.tight;
    way = to;
    asked = 0;
}

bool emulate_lost(bool more)
{
    asked += more;
    return way.lost && asked >= way.lost;
}

/* The k-th of n, from the first or from the last on. */
static unsigned turn(int64_t k, int64_t n, bool first)
{
    return (unsigned)(first ? k : n - 1 - k);
}

void emulate_items(int64_t n, int threads, emulate_call kernel)
{
    int64_t blocks = n > 0 ? (n + threads - 1) / threads : 0;
    if (blocks && emulate_lost(true))
        return;
    gridDim = {(unsigned)blocks, 1, 1};
    blockDim = {(unsigned)threads, 1, 1};
    for (int64_t b = 0; b < blocks; b++)
        for (int t = 0; t < threads; t++) {
            blockIdx = {turn(b, blocks, way.descending), 0, 0};
            threadIdx = {turn(t, threads, !way.descending), 0, 0};
            kernel.run(kernel.with);
        }
}

/* ---- Fibers ---- */

/* A thread of a block is a fiber that runs kernel after kernel. It is started
 * with a stack of its own; after that jumps lead from each to the next. They
 * are the compiler's, which keep three words where setjmp keeps registers,
 * encrypted: changing threads is most of what a barrier costs. Stacks whose
 * distance is a power of two would share a few lines of the cache. */
enum { STACK = (1 << 20) + 9 * 64, THREADS = 1024, JUMP = 5 };
static __thread ucontext_t begun;
static __thread void *scheduler[JUMP], *fiber[THREADS][JUMP];
static __thread bool done[THREADS], started[THREADS];
static __thread const emulate_call *running; /* NULL: no fibers */
static thread_local struct stacks {
    char *of = NULL; /* the first fiber's */
    ~stacks() { free(of); }
} stack;

/* Fibers are numbered in the order in which they run; so a rank's are one run,
 * from `first` to before `end` of the rank that is at work. */
enum meeting { NOWHERE, OF_RANK, OF_TEAM };
static __thread unsigned in_block, in_rank, to_run, here, first, end;
static __thread enum meeting met;      /* where those of the rank wait so far */
static __thread int barriers[THREADS]; /* that a fiber has come to */

/* What copy_ahead has begun, by number of the group. */
struct pending {
    void *to;
    const void *from;
    size_t bytes;
    int group;
};
static thread_local std::vector<pending> ahead[THREADS];
static __thread int groups[THREADS];

static void live(void);

/* Goes on with a fiber, and never returns. */
static __attribute__((noinline)) void resume(unsigned f)
{
    here = f;
    threadIdx = {turn(f, in_block, !way.descending), 0, 0};
    if (started[f])
        __builtin_longjmp(fiber[f], 1);
    started[f] = true;
    getcontext(&begun);
    begun.uc_stack.ss_sp = &stack.of[(size_t)f * STACK];
    begun.uc_stack.ss_size = STACK;
    makecontext(&begun, live, 0);
    setcontext(&begun);
}

/* The fiber after f that has not returned. When all of a rank wait it goes on,
 * at a barrier of its own; else the next rank does, so that each runs as far as
 * it can without the others. */
static unsigned next(unsigned f)
{
    for (;;) {
        while (++f < end)
            if (!done[f])
                return f;
        if (met != OF_RANK) {
            first = end < in_block ? end : 0;
            end = first + in_rank;
        }
        met = NOWHERE;
        f = first - 1;
    }
}

/* From this fiber to the next, to the scheduler when all have returned. Returns
 * when this one is resumed. */
static __attribute__((noinline)) void leave(void)
{
    if (__builtin_setjmp(fiber[here]))
        return;
    if (to_run == 0)
        __builtin_longjmp(scheduler, 1);
    resume(next(here));
}

static void live(void)
{
    for (;;) {
        running->run(running->with);
        done[here] = true;
        to_run--;
        leave();
    }
}

static void meet(enum meeting at)
{
    if (!running || (met && met != at)) {
        fputs(running ? "emulate: threads of a rank at unlike barriers\n"
                      : "emulate: a barrier in a kernel of items\n",
              stderr);
        abort();
    }
    met = at;
    leave();
}

void emulate_meet(void)
{
    meet(OF_RANK);
}

void emulate_team_sync(bool alone)
{
    int n = running ? ++barriers[here] : 0;
    if (!running || n != way.left_out)
        meet(alone || (n && n == way.parted) ? OF_RANK : OF_TEAM);
}

void __syncthreads(void)
{
    emulate_team_sync(true);
}

/* All fibers go on from barrier to barrier until all have returned. */
static __attribute__((noinline)) void run_block(void)
{
    memset(done, 0, in_block * sizeof *done);
    memset(barriers, 0, in_block * sizeof *barriers);
    to_run = in_block;
    first = 0;
    end = in_rank;
    met = NOWHERE;
    if (!__builtin_setjmp(scheduler))
        resume(0);
}

static void run_blocks(int64_t blocks, int ranks, int threads,
                       const emulate_call *kernel)
{
    if (!stack.of)
        stack.of = (char *)malloc((size_t)THREADS * STACK);
    in_rank = (unsigned)threads;
    in_block = (unsigned)(ranks * threads);
    gridDim = {(unsigned)(blocks > 0 ? blocks : 0), 1, 1};
    blockDim = {in_block, 1, 1};
    if (blocks > 0 && emulate_lost(true))
        return;
    running = kernel;
    for (int64_t b = 0; b < blocks; b++) {
        blockIdx = {turn(b, blocks, way.descending), 0, 0};
        run_block();
    }
    running = NULL;
}

void emulate_blocks(int64_t blocks, int threads, emulate_call kernel)
{
    run_blocks(blocks, 1, threads, &kernel);
}

bool gpu_loop(struct gpu *g, struct loop_key key, const int32_t *again,
              loop_turn turn)
{
    (void)key;
    int queues = gpu_queues(g, (const void *)gpu_loop);
    if (queues == 0) /* a tape has done it */
        return !g->failed;
    if (g->hosted[0] || g->hosted[1]) {
        gpu_tape_spoil(g);
        return false;
    }
    enum tape_mode tape = g->tape;
    int status = DRAPE_OK;
    g->tape = TAPE_OFF;
    do
        status = turn.run(turn.with);
    while (status == DRAPE_OK && again && *again && !g->failed &&
           !emulate_lost(false));
    g->tape = tape;
    if (queues > 1 && status == DRAPE_OK)
        reel_record_loop(g, again, turn);
    return status == DRAPE_OK;
}

/* ---- Teams ---- */

alignas(16) static thread_local double room[EMULATE_RANKS]
                                           [EMULATE_ROOM / sizeof(double)];

char *emulate_room(int rank)
{
    return (char *)room[rank];
}

/* What a kernel has not written itself must not be there from the one before:
 * that may have been the same. */
void emulate_team(int ranks, int threads, emulate_call kernel)
{
    memset(room, 0xff, sizeof room);
    for (int f = 0; f < ranks * threads; f++) {
        ahead[f].clear();
        groups[f] = 0;
    }
    emulate_ranks = ranks;
    run_blocks(ranks > 0, ranks, threads, &kernel);
}

void emulate_copy(void *to, const void *from, size_t bytes)
{
    if (way.descending)
        ahead[here].push_back({to, from, bytes, groups[here]});
    else
        memcpy(to, from, bytes);
}

void emulate_copies_group(void)
{
    groups[here]++;
}

void emulate_copies_end(int left)
{
    std::vector<pending> &a = ahead[here];
    size_t n = 0;
    for (; n < a.size() && a[n].group < groups[here] - left; n++)
        memcpy(a[n].to, a[n].from, a[n].bytes);
    a.erase(a.begin(), a.begin() + (ptrdiff_t)n);
}
