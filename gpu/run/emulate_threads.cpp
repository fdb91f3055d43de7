/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the threads of a device on the host. gpu/run/emulate.h */
#include "gpu/run/loop.cuh"

#include <condition_variable>
#include <stdio.h>
#include <stdlib.h>
#include <thread>
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
    g->tight = to.tight;
    way = to;
    asked = 0;
}

void emulate_next_order(void)
{
    static __thread int opened;
    opened++;
    way.descending = opened % 3 == 1;
    way.shuffled = opened % 3 == 2 ? opened : 0;
}

bool emulate_lost(bool more)
{
    asked += more;
    return way.lost && asked >= way.lost;
}

/* An order of n things: from, from + step, from + 2 step, … modulo n; step and
 * n have no common divisor. */
struct order {
    int64_t n, step, from;
};

static int64_t common(int64_t a, int64_t b)
{
    return b ? common(b, a % b) : a;
}

/* Returns the order of n things that the way asks for: ascending, descending or
 * shuffled. */
static struct order order_of(int64_t n, bool first)
{
    int64_t step = way.shuffled;
    if (n < 1 || !way.shuffled)
        return {n, first ? 1 : n - 1, first ? 0 : n - 1};
    while (common(step, n) != 1)
        step++;
    return {n, step % n, step / 2 % n};
}

static unsigned place_in_order(const struct order *o, int64_t k)
{
    return (unsigned)((o->from + k * o->step) % o->n);
}

void emulate_items(int64_t n, int rows, int threads, emulate_call kernel)
{
    int64_t blocks = n > 0 ? (n + threads - 1) / threads : 0;
    if (blocks && emulate_lost(true))
        return;
    struct order block = order_of(blocks * rows, way.descending);
    struct order thread = order_of(threads, !way.descending);
    gridDim = {(unsigned)blocks, (unsigned)rows, 1};
    blockDim = {(unsigned)threads, 1, 1};
    for (int64_t b = 0; b < blocks * rows; b++)
        for (int t = 0; t < threads; t++) {
            unsigned at = place_in_order(&block, b);
            blockIdx = {at % gridDim.x, at / gridDim.x, 0};
            threadIdx = {place_in_order(&thread, t), 0, 0};
            kernel.run(kernel.with);
        }
}

/* Each thread of a block is a fiber with a stack of its own, which serves
 * kernel after kernel. Fibers switch by the compiler's __builtin_setjmp, which
 * saves three words where setjmp saves and encrypts all registers: switching is
 * most of the cost of a barrier. The distance between stacks is not a power of
 * two, as stacks would then share a few lines of the cache. */
enum { STACK = (1 << 20) + 9 * 64, THREADS = 1024, JUMP = 5, WARP = 32 };
static __thread ucontext_t begun;
static __thread void *scheduler[JUMP], *fiber[THREADS][JUMP];
static __thread bool done[THREADS], started[THREADS];
static __thread const emulate_call *running; /* NULL: no fibers */
static thread_local struct stacks {
    char *of = NULL; /* the first fiber's */
    ~stacks() { free(of); }
} stack;

/* Fibers are numbered in the order in which they run. The fibers of a rank are
 * consecutive, those of the rank that runs now go from `first` to before `end`;
 * the fibers of a warp are consecutive, too. */
enum meeting { NOWHERE, OF_WARP, OF_RANK, OF_CLUSTER };
static __thread unsigned in_block, in_rank, in_warp, to_run, here;
static __thread unsigned first, end, warp_end;
static __thread enum meeting met;      /* where those of the rank wait so far */
static __thread enum meeting met_warp; /* those of the warp */
static __thread int barriers[THREADS]; /* that a fiber has come to */
static __thread unsigned thread_of[THREADS]; /* a fiber is */

/* A block that waits within a barrier for the other blocks of its kernel. It
 * runs in a thread of the host of its own, and so has shared memory of its own.
 */
struct parked {
    std::mutex lock;
    std::condition_variable change;
    bool others; /* the other blocks run now */
    bool over;   /* they have ended */
    int left;    /* barriers to the one where it waits */
};
static __thread struct parked *parked; /* NULL: the block does not wait */

static void park(struct parked *p)
{
    std::unique_lock<std::mutex> lock(p->lock);
    p->others = true;
    p->change.notify_all();
    while (!p->over)
        p->change.wait(lock);
}

/* An asynchronous copy that has not been made yet, and its group. */
struct pending {
    void *to;
    const void *from;
    size_t bytes;
    int group;
};
static thread_local std::vector<pending> ahead[THREADS];
static __thread int groups[THREADS];

static void live(void);

/* Switches to a fiber; does not return. */
static __attribute__((noinline)) void resume(unsigned f)
{
    here = f;
    threadIdx = {thread_of[f], 0, 0};
    if (started[f])
        __builtin_longjmp(fiber[f], 1);
    started[f] = true;
    getcontext(&begun);
    begun.uc_stack.ss_sp = &stack.of[(size_t)f * STACK];
    begun.uc_stack.ss_size = STACK;
    makecontext(&begun, live, 0);
    setcontext(&begun);
}

/* Returns the fiber that runs after f. A warp continues when all of its fibers
 * wait at a barrier of the warp, a rank when all of its fibers wait at one of
 * the rank. Otherwise the next warp or rank runs, so that each gets as far as
 * it can without the others. */
static unsigned next(unsigned f)
{
    f++;
    for (;;) {
        for (; f < warp_end; f++)
            if (!done[f])
                return f;
        if (met_warp == OF_WARP)
            f = warp_end - in_warp;
        else if (warp_end < end)
            f = warp_end;
        else {
            if (met != OF_RANK) {
                first = end < in_block ? end : 0;
                end = first + in_rank;
            }
            met = NOWHERE;
            f = first;
        }
        warp_end = f + in_warp;
        met_warp = NOWHERE;
    }
}

/* Switches from this fiber to the next one, or to the scheduler if all fibers
 * have returned. Returns when this fiber runs again. */
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
    bool unlike =
        (met_warp && met_warp != at) || (at != OF_WARP && met && met != at);
    if (!running || unlike) {
        fputs(running ? "emulate: threads of a rank at unlike barriers\n"
                      : "emulate: a barrier in a kernel of items\n",
              stderr);
        abort();
    }
    met_warp = at;
    met = at == OF_WARP ? met : at;
    if (parked && at != OF_WARP && --parked->left == 0)
        park(parked);
    leave();
}

void emulate_meet_warp(void)
{
    meet(OF_WARP);
}

void emulate_meet(void)
{
    meet(OF_RANK);
}

void emulate_cluster_sync(bool alone)
{
    int n = running ? ++barriers[here] : 0;
    if (!running || n != way.left_out)
        meet(alone || (n && n == way.parted) ? OF_RANK : OF_CLUSTER);
}

void __syncthreads(void)
{
    emulate_cluster_sync(true);
}

/* Runs all fibers of a block, from barrier to barrier, until all have returned.
 */
static __attribute__((noinline)) void run_block(void)
{
    memset(done, 0, in_block * sizeof *done);
    memset(barriers, 0, in_block * sizeof *barriers);
    to_run = in_block;
    first = 0;
    end = in_rank;
    warp_end = in_warp;
    met = met_warp = NOWHERE;
    if (!__builtin_setjmp(scheduler))
        resume(0);
}

/* Puts ranks, warps of a rank and lanes of a warp in the order of the way. */
static void order_threads(int ranks)
{
    unsigned warps = in_rank / in_warp;
    struct order rank = order_of(ranks, !way.descending);
    struct order warp = order_of(warps, !way.descending);
    struct order lane = order_of(in_warp, !way.descending);
    for (unsigned f = 0; f < in_block; f++)
        thread_of[f] = place_in_order(&rank, f / in_rank) * in_rank +
                       place_in_order(&warp, f / in_warp % warps) * in_warp +
                       place_in_order(&lane, f % in_warp);
}

alignas(16) static thread_local double room[EMULATE_RANKS]
                                           [EMULATE_SHARED / sizeof(double)];

/* The shared memory of a cluster is filled with poison first, as a kernel must
 * not rely on what the kernel before it, which may have been the same, left
 * there. */
static void clear_cluster(void)
{
    memset(room, 0xff, sizeof room);
    for (unsigned f = 0; f < in_block; f++) {
        ahead[f].clear();
        groups[f] = 0;
    }
}

/* The launch under way: what threads of the host that run blocks of it must
 * know. */
struct launch {
    unsigned blocks, rows, ranks, threads; /* ranks: 0: it is no cluster */
    const emulate_call *kernel;
    struct gpu_way way;
};

static void prepare(const struct launch *l)
{
    if (!stack.of)
        stack.of = (char *)malloc((size_t)THREADS * STACK);
    way = l->way;
    unsigned ranks = l->ranks ? l->ranks : 1;
    emulate_ranks = (int)ranks;
    in_rank = l->threads;
    in_block = ranks * l->threads;
    in_warp = in_rank % WARP ? in_rank : (unsigned)WARP;
    gridDim = {l->blocks, l->rows, 1};
    blockDim = {in_block, 1, 1};
    order_threads((int)ranks);
}

static void run_one(const struct launch *l, unsigned block)
{
    if (l->ranks)
        clear_cluster();
    running = l->kernel;
    blockIdx = {block % l->blocks, block / l->blocks, 0};
    run_block();
    running = NULL;
}

/* Runs a block until it waits or ends; run_parked lets it go on. */
static void be_parked(struct parked *p, const struct launch *l, unsigned block)
{
    parked = p;
    prepare(l);
    run_one(l, block);
    std::unique_lock<std::mutex> lock(p->lock);
    p->others = true;
    p->change.notify_all();
}

static void run_blocks(int64_t each, int rows, int ranks, int threads,
                       const emulate_call *kernel)
{
    int64_t blocks = each > 0 ? each * rows : 0;
    struct launch l = {(unsigned)each,    (unsigned)rows, (unsigned)ranks,
                       (unsigned)threads, kernel,         way};
    struct parked p = {};
    std::thread first;
    prepare(&l);
    if (blocks > 0 && emulate_lost(true))
        return;
    struct order block = order_of(blocks, way.descending);
    int64_t b = 0;
    if (way.parked && blocks > 1) {
        p.left = way.parked;
        first = std::thread(be_parked, &p, &l, place_in_order(&block, b++));
        std::unique_lock<std::mutex> lock(p.lock);
        while (!p.others)
            p.change.wait(lock);
    }
    for (; b < blocks; b++)
        run_one(&l, place_in_order(&block, b));
    if (first.joinable()) {
        p.lock.lock();
        p.over = true;
        p.lock.unlock();
        p.change.notify_all();
        first.join();
    }
}

void emulate_blocks(int64_t blocks, int rows, int threads, emulate_call kernel)
{
    run_blocks(blocks, rows, 0, threads, &kernel);
}

bool gpu_loop(struct gpu *g, struct loop_key key, const struct loop &of)
{
    (void)key;
    if (g->failed || g->hosted[0] || g->hosted[1] || g->together)
        return false;
    int status = of.first.run(of.first.with);
    while (status == DRAPE_OK && of.again && *of.again && !g->failed &&
           !emulate_lost(false))
        status = of.body.run(of.body.with);
    return (status == DRAPE_OK ? of.last.run(of.last.with) : status) ==
           DRAPE_OK;
}

char *emulate_shared(int rank)
{
    return (char *)room[rank];
}

void emulate_cluster(int ranks, int rows, int threads, emulate_call kernel)
{
    run_blocks(ranks > 0, rows, ranks, threads, &kernel);
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
