/* SPDX-License-Identifier: Apache-2.0 */
/* Advances several worlds together, for real and emulated devices: the host's
 * work for a world is a fiber, which waits whenever it would wait for the
 * device. gpu/run/batch.cuh */
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

#include "gpu/run/batch.cuh"

/* STACK: bytes of a fiber's stack. SHARES: batches that are made of the worlds
 * of one call, each of SHARE worlds at least: while the device works for one of
 * them, the host works for the others. */
enum { STACK = 1 << 18, SHARES = 4, SHARE = 16 };
/* RANKS: blocks of a cluster, as other worlds fill the device. PARTS: the
 * number of multiprocessors for which kernels are cut. */
enum { RANKS = 1, PARTS = 4 };

/* A thread of the host, which works for every (workers)-th world. */
struct worker {
    struct batch *batch;
    int number;
    pthread_t thread;
    ucontext_t home;
};

static __thread struct gpu_seat *starting;

void gpu_batch_meet(struct gpu *g)
{
    swapcontext(&g->seat->here, &g->seat->worker->home);
}

void gpu_batch_step(struct gpu *g)
{
    g->seat->steps++;
}

void *gpu_batch_pinned(struct gpu *g)
{
    return g->seat->pinned;
}

/* Waits until all workers have come; the last one does `last` first. The lock
 * is held. */
static void meet_workers(struct batch *b, void (*last)(struct batch *b))
{
    int64_t before = b->generation;
    if (++b->arrived < b->workers) {
        while (b->generation == before)
            pthread_cond_wait(&b->change, &b->lock);
        return;
    }
    last(b);
    b->arrived = 0;
    b->generation++;
    pthread_cond_broadcast(&b->change);
}

static void launch_if_left(struct batch *b)
{
    if (b->left)
        gpu_batch_launch(b);
}

static void ask_again(struct batch *b)
{
    b->left = false;
}

/* A worker comes here when each of its worlds waits or is over. left: one of
 * them waits. Returns whether any waits, when all have come. */
static bool come(struct batch *b, bool left)
{
    pthread_mutex_lock(&b->lock);
    b->left |= left;
    meet_workers(b, launch_if_left);
    left = b->left;
    meet_workers(b, ask_again);
    pthread_mutex_unlock(&b->lock);
    return left;
}

/* The whole life of a fiber. */
static void begin(void)
{
    struct gpu_seat *s = starting;
    struct batch *b = s->batch;
    int k = 0;
    while (b->seat[k] != s)
        k++;
    b->work(b->with, k);
    gpu_batch_meet(s->g);
    s->over = true;
    setcontext(&s->worker->home);
}

static void start(struct gpu_seat *s, struct worker *w)
{
    s->worker = w;
    getcontext(&s->here);
    s->here.uc_stack.ss_sp = s->stack;
    s->here.uc_stack.ss_size = STACK;
    s->here.uc_link = NULL;
    makecontext(&s->here, begin, 0);
}

static void *run(void *user)
{
    struct worker *w = (struct worker *)user;
    struct batch *b = w->batch;
    bool left = true;
    pthread_mutex_lock(&b->lock); /* until the number of workers is known */
    pthread_mutex_unlock(&b->lock);
    gpu_enter(b->seat[0]->g);
    for (int k = w->number; k < b->n; k += b->workers)
        start(b->seat[k], w);
    while (left) {
        left = false;
        for (int k = w->number; k < b->n; k += b->workers) {
            starting = b->seat[k];
            if (!starting->over && !starting->held)
                swapcontext(&w->home, &starting->here);
            left |= !b->seat[k]->over;
        }
        left = come(b, left);
    }
    return NULL;
}

/* Starts a thread that blocks all signals: they are for those of the host
 * program. */
static bool create(pthread_t *thread, void *(*body)(void *), void *with)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    bool made = !pthread_create(thread, NULL, body, with);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return made;
}

/* Works for all worlds with so many workers, of which this thread is one. */
static void work_all(struct batch *b, struct worker *w, int workers)
{
    pthread_mutex_init(&b->lock, NULL);
    pthread_cond_init(&b->change, NULL);
    pthread_mutex_lock(&b->lock);
    for (int k = 0; k < workers; k++) {
        w[k].batch = b;
        w[k].number = k;
    }
    b->workers = 1;
    while (b->workers < workers &&
           create(&w[b->workers].thread, run, &w[b->workers]))
        b->workers++;
    pthread_mutex_unlock(&b->lock);
    run(w);
    for (int k = 1; k < b->workers; k++)
        pthread_join(w[k].thread, NULL);
    pthread_cond_destroy(&b->change);
    pthread_mutex_destroy(&b->lock);
}

/* Gives a device its seat. False if there is no memory. */
static bool take_seat(struct gpu *g)
{
    if (!g->seat)
        g->seat = (struct gpu_seat *)arena_take(&g->host, ARENA_OTHER, 1,
                                                sizeof *g->seat);
    struct gpu_seat *s = g->seat;
    if (!s)
        return false;
    s->g = g;
    if (!s->stack)
        s->stack = (char *)arena_take(&g->host, ARENA_OTHER, STACK, 1);
    if (s->stack && !s->pinned)
        s->pinned = gpu_pin(g, GPU_PINNED);
    return s->stack && s->pinned;
}

/* Puts a device into a batch, which launches on the first one's stream. */
static void enter(struct batch *b, struct gpu_seat *s)
{
    struct gpu *g = s->g;
    gpu_wait_now(g);
    s->batch = b;
    s->over = s->held = false;
    s->steps = 0;
    s->used = s->at = 0;
    s->count = 0;
    s->stream = (void *)g->stream;
    s->ranks = g->ranks;
    s->multiprocessors = g->multiprocessors;
    g->stream = b->on.stream;
    g->ranks = RANKS;
    g->multiprocessors = PARTS;
    g->together = true;
}

static void leave(struct gpu_seat *s)
{
    struct gpu *g = s->g;
    g->together = false;
    g->stream = (decltype(g->stream))s->stream;
    g->ranks = s->ranks;
    g->multiprocessors = s->multiprocessors;
    s->batch = NULL;
}

/* A batch, of the worlds from `first` on. */
struct share {
    struct gpu *const *g;
    int first, n, threads;
    void (*work)(void *with, int k);
    void *with;
    struct batch *batch;
    struct worker *worker;
    pthread_t thread;
    bool apart; /* it has a thread of its own */
};

static void work_in_share(void *with, int k)
{
    const struct share *s = (const struct share *)with;
    s->work(s->with, s->first + k);
}

/* Takes the memory of a share. False if there is none. */
static bool take_share(struct share *s)
{
    s->batch = (struct batch *)calloc(1, sizeof *s->batch);
    s->worker = (struct worker *)calloc((size_t)s->threads, sizeof *s->worker);
    if (!s->batch || !s->worker)
        return false;
    s->batch->seat =
        (struct gpu_seat **)calloc((size_t)s->n, sizeof *s->batch->seat);
    bool room = s->batch->seat != NULL;
    for (int k = 0; k < s->n && room; k++) {
        room = take_seat(s->g[s->first + k]);
        s->batch->seat[k] = s->g[s->first + k]->seat;
    }
    s->batch->n = s->n;
    s->batch->work = work_in_share;
    s->batch->with = s;
    return room;
}

static void free_share(struct share *s)
{
    if (s->batch) {
        free(s->batch->kind);
        free(s->batch->waited);
        free(s->batch->group);
        free(s->batch->seat);
    }
    free(s->batch);
    free(s->worker);
}

static void *run_share(void *with)
{
    struct share *s = (struct share *)with;
    struct batch *b = s->batch;
    gpu_enter(s->g[s->first]);
    b->on = *s->g[s->first];
    b->on.failed = DRAPE_OK;
    for (int k = 0; k < s->n; k++)
        enter(b, b->seat[k]);
    work_all(b, s->worker, s->threads);
    for (int k = 0; k < s->n; k++)
        leave(b->seat[k]);
    return NULL;
}

/* Runs the shares beside each other. */
static void run_shares(struct share *s, int shares)
{
    for (int k = 1; k < shares; k++)
        s[k].apart = create(&s[k].thread, run_share, &s[k]);
    run_share(&s[0]);
    for (int k = 1; k < shares; k++) {
        if (s[k].apart)
            pthread_join(s[k].thread, NULL);
        else
            run_share(&s[k]);
    }
}

static int least_of(int a, int b)
{
    return a < b ? a : b;
}

int gpu_batch(struct gpu *const *g, int n, int threads,
              void (*work)(void *with, int k), void *with)
{
    struct share s[SHARES] = {};
    int shares = least_of(least_of(SHARES, threads), 1 + (n - 1) / SHARE);
    bool room = true;
    for (int k = 0; k < shares; k++) {
        int first = (int)((int64_t)n * k / shares);
        int end = (int)((int64_t)n * (k + 1) / shares);
        s[k].g = g;
        s[k].first = first;
        s[k].n = end - first;
        s[k].threads = least_of(threads / shares, end - first);
        s[k].work = work;
        s[k].with = with;
        room = take_share(&s[k]) && room;
    }
    if (room)
        run_shares(s, shares);
    for (int k = 0; k < shares; k++)
        free_share(&s[k]);
    return room ? DRAPE_OK : DRAPE_ENOMEM;
}

void gpu_batch_close(struct gpu *g)
{
    if (!g->seat)
        return;
    gpu_unpin(g, g->seat->pinned);
    gpu_unpin(g, g->seat->host);
    arena_give(&g->host, g->seat->data);
    arena_give(&g->host, g->seat->stack);
    arena_give(&g->host, g->seat);
    g->seat = NULL;
}

void gpu_launch(struct gpu *g, const struct kernel_ways *k,
                const struct launch_shape *s, const void *args)
{
    if (g->failed || s->blocks < 1)
        return;
    if (g->together && s->kind == OF_GRID)
        gpu_batch_meet(g);
    if (g->together && s->kind != OF_GRID)
        gpu_batch_keep(g, k, s, args);
    else
        gpu_launch_now(g, k, s, args, 1);
}
