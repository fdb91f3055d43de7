/* SPDX-License-Identifier: Apache-2.0 */
/* Advances several worlds together, for real and emulated devices.
 * gpu/run/batch.cuh */
#include "gpu/run/batch.cuh"

#include <pthread.h>
#include <stdlib.h>
#include <ucontext.h>

/* STACK: bytes of the stack on which the host works for a world. RANKS: blocks
 * of a cluster, as the device is full without more. PARTS: what kernels that
 * fill the device are cut for. */
enum { STACK = 1 << 18, ALIGNED = 16, FIRST_ROOM = 1 << 13 };
enum { RANKS = 1, PARTS = 4 };

/* A launch that is kept; its arguments follow it. */
struct kept {
    const struct kernel_ways *ways;
    struct launch_shape shape;
    size_t bytes; /* of this struct and the arguments, rounded up */
};

/* A world's place in a batch. */
struct gpu_seat {
    struct gpu *g;
    struct batch *batch;
    struct worker *worker;
    ucontext_t here;
    char *stack;
    bool over;
    char *data; /* the launches that are kept, those from `at` on to be made */
    size_t used, room, at;
    void *pinned;
    char *host, *device; /* staging memory for the batches that this world is
                            the first of: pinned, and of the device */
    size_t staging;
    void *stream; /* these four: what g has outside batches */
    int ranks, multiprocessors;
};

/* A thread of the host, which works for every (workers)-th world. */
struct worker {
    struct batch *batch;
    int number;
    pthread_t thread;
    ucontext_t home;
};

/* Launches that are made as one. */
struct group {
    const struct kept *first; /* of the first world that has it */
    struct launch_shape shape;
    size_t begin; /* byte of the arguments of all worlds in the staging memory */
    int worlds;
};

struct batch {
    struct gpu_seat **seat;
    int n, workers;
    struct gpu on; /* launches: the first world's device, with none of its own
                      failures */
    void (*work)(void *with, int k);
    void *with;
    pthread_mutex_t lock;
    pthread_cond_t turn;
    int arrived;
    int64_t turns;
    bool left; /* a world is not over */
    struct group *group;
    int groups, most_groups;
    size_t staged; /* bytes of the staging memory */
};

static const struct kept *head(const struct gpu_seat *s)
{
    return s->at < s->used ? (const struct kept *)(s->data + s->at) : NULL;
}

static const struct kept *after(const struct gpu_seat *s, const struct kept *k)
{
    const char *next = (const char *)k + k->bytes;
    return next < s->data + s->used ? (const struct kept *)next : NULL;
}

/* Makes room for so many bytes, of which the used ones stay. False if there is
 * no memory. */
static bool grow(struct gpu_seat *s, size_t bytes)
{
    size_t room = s->room ? s->room : (size_t)FIRST_ROOM;
    if (s->used + bytes <= s->room)
        return true;
    while (room < s->used + bytes)
        room *= 2;
    char *data =
        (char *)arena_take(&s->g->host, ARENA_OTHER, (int64_t)room, 1);
    if (!data)
        return false;
    if (s->used)
        memcpy(data, s->data, s->used);
    arena_give(&s->g->host, s->data);
    s->data = data;
    s->room = room;
    return true;
}

void gpu_batch_keep(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *shape, const void *args)
{
    struct gpu_seat *s = g->seat;
    size_t all = (sizeof(struct kept) + k->bytes + ALIGNED - 1) / ALIGNED *
                 ALIGNED;
    if (!grow(s, all)) {
        g->failed = DRAPE_ENOMEM;
        return;
    }
    struct kept *one = (struct kept *)(s->data + s->used);
    *one = {k, *shape, all};
    memcpy(one + 1, args, k->bytes);
    s->used += all;
}

void gpu_batch_meet(struct gpu *g)
{
    struct gpu_seat *s = g->seat;
    swapcontext(&s->here, &s->worker->home);
}

void *gpu_batch_pinned(struct gpu *g)
{
    return g->seat->pinned;
}

/* Whether two launches can be made as one. */
static bool alike(const struct kept *a, const struct kept *b)
{
    const struct launch_shape *s = &a->shape, *t = &b->shape;
    return a->ways == b->ways && s->threads == t->threads &&
           s->rows == t->rows && (s->kind == OF_ITEMS || s->blocks == t->blocks);
}

/* The number of worlds that have such a launch to make, but not next. */
static int later(const struct batch *b, const struct kept *k)
{
    int n = 0;
    for (int w = 0; w < b->n; w++) {
        const struct gpu_seat *s = b->seat[w];
        const struct kept *o = head(s);
        if (!o || alike(o, k))
            continue;
        while (o && !alike(o, k))
            o = after(s, o);
        n += o != NULL;
    }
    return n;
}

/* Returns the launch that is made next, or NULL if none is left: one for which
 * the fewest worlds have others to make first. */
static const struct kept *choose(const struct batch *b)
{
    enum { KINDS = 8 };
    const struct kept *seen[KINDS], *best = NULL;
    int kinds = 0, least = 0;
    for (int w = 0; w < b->n && kinds < KINDS; w++) {
        const struct kept *k = head(b->seat[w]);
        bool known = !k;
        for (int o = 0; o < kinds && !known; o++)
            known = alike(seen[o], k);
        if (!known)
            seen[kinds++] = k;
    }
    for (int o = 0; o < kinds; o++) {
        int wait = kinds > 1 ? later(b, seen[o]) : 0;
        if (!best || wait < least) {
            best = seen[o];
            least = wait;
        }
    }
    return best;
}

static size_t whole(size_t bytes)
{
    return (bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
}

/* Makes room for so many bytes of staging memory; those that are staged stay.
 * False if there is no memory. */
static bool grow_staging(struct batch *b, size_t bytes)
{
    struct gpu_seat *s = b->seat[0];
    size_t room = 2 * (b->staged + bytes);
    if (b->staged + bytes <= s->staging)
        return true;
    s->g->together = false; /* its memory is taken at once */
    char *host = (char *)gpu_pin(s->g, room);
    char *device =
        (char *)gpu_take(s->g, ARENA_SCRATCH, (int64_t)room, sizeof *device);
    if (host && device) {
        memcpy(host, s->host, b->staged);
        gpu_unpin(s->g, s->host);
        gpu_give(s->g, s->device);
        s->host = host;
        s->device = device;
        s->staging = room;
    } else {
        gpu_unpin(s->g, host);
        gpu_give(s->g, device);
    }
    s->g->together = true;
    return s->staging == room;
}

/* Makes room for one more group. False if there is no memory. */
static bool grow_groups(struct batch *b)
{
    int most = b->most_groups ? 2 * b->most_groups : 64;
    if (b->groups < b->most_groups)
        return true;
    void *all = realloc(b->group, (size_t)most * sizeof *b->group);
    if (!all)
        return false;
    b->group = (struct group *)all;
    b->most_groups = most;
    return true;
}

/* Stages one launch of every world that has it to make next. False if there is
 * no memory. */
static bool stage(struct batch *b, const struct kept *k)
{
    size_t bytes = k->ways->bytes;
    if (!grow_groups(b) || !grow_staging(b, whole(bytes * (size_t)b->n)))
        return false;
    struct group *o = &b->group[b->groups++];
    *o = {k, k->shape, b->staged, 0};
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        const struct kept *mine = head(s);
        if (!mine || !alike(mine, k))
            continue;
        const struct launch_shape *t = &mine->shape;
        o->shape.items = t->items > o->shape.items ? t->items : o->shape.items;
        o->shape.blocks =
            t->blocks > o->shape.blocks ? t->blocks : o->shape.blocks;
        o->shape.bytes = t->bytes > o->shape.bytes ? t->bytes : o->shape.bytes;
        memcpy(b->seat[0]->host + b->staged + bytes * (size_t)o->worlds++,
               mine + 1, bytes);
        s->at += mine->bytes;
    }
    b->staged += whole(bytes * (size_t)o->worlds);
    return true;
}

/* Makes all launches that worlds have kept, and waits until they are done. */
static void launch_all(struct batch *b)
{
    const struct gpu_seat *first = b->seat[0];
    bool room = true;
    b->staged = 0;
    b->groups = 0;
    for (const struct kept *k; room && (k = choose(b));)
        room = stage(b, k);
    if (!room)
        b->on.failed = DRAPE_ENOMEM;
    gpu_up_now(&b->on, first->device, first->host, b->staged);
    for (int k = 0; k < b->groups; k++) {
        const struct group *o = &b->group[k];
        gpu_launch_now(&b->on, o->first->ways, &o->shape,
                       (o->worlds > 1 ? first->device : first->host) + o->begin,
                       o->worlds);
    }
    gpu_wait_now(&b->on);
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        s->used = s->at = 0;
        if (b->on.failed && !s->g->failed) {
            s->g->failed = b->on.failed;
            memcpy(s->g->name, b->on.name, sizeof s->g->name);
        }
    }
    if (b->on.failed == DRAPE_ENOMEM)
        b->on.failed = DRAPE_OK;
}

/* Waits until all workers have come; the last one does `last` first. The lock is
 * held. */
static void meet_workers(struct batch *b, void (*last)(struct batch *b))
{
    int64_t turn = b->turns;
    if (++b->arrived < b->workers) {
        while (b->turns == turn)
            pthread_cond_wait(&b->turn, &b->lock);
        return;
    }
    last(b);
    b->arrived = 0;
    b->turns++;
    pthread_cond_broadcast(&b->turn);
}

static void launch_if_left(struct batch *b)
{
    if (b->left)
        launch_all(b);
}

static void ask_again(struct batch *b)
{
    b->left = false;
}

/* A worker comes here when each of its worlds waits or is over. left: one of
 * them waits. Returns whether any does when all have come, and launches. */
static bool come(struct batch *b, bool left)
{
    pthread_mutex_lock(&b->lock);
    b->left |= left;
    meet_workers(b, launch_if_left);
    bool more = b->left;
    meet_workers(b, ask_again);
    pthread_mutex_unlock(&b->lock);
    return more;
}

static __thread struct gpu_seat *starting;

static void begin(void)
{
    struct gpu_seat *s = starting;
    int k = 0;
    while (s->batch->seat[k] != s)
        k++;
    s->batch->work(s->batch->with, k);
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
            if (!starting->over)
                swapcontext(&w->home, &starting->here);
            left |= !b->seat[k]->over;
        }
        left = come(b, left);
    }
    return NULL;
}

/* Makes the seat of a device, which it keeps. False if there is no memory. */
static bool take_seat(struct gpu *g)
{
    struct gpu_seat *s = g->seat;
    if (!s)
        s = g->seat =
            (struct gpu_seat *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *s);
    if (!s)
        return false;
    s->g = g;
    if (!s->stack)
        s->stack = (char *)arena_take(&g->host, ARENA_OTHER, STACK, 1);
    if (!s->pinned)
        s->pinned = gpu_pin(g, GPU_PINNED);
    return s->stack && s->pinned;
}

/* Puts a device into a batch, which launches on the first one's stream. */
static void enter(struct batch *b, int k)
{
    struct gpu *g = b->seat[k]->g;
    struct gpu_seat *s = g->seat;
    gpu_wait_now(g);
    s->batch = b;
    s->over = false;
    s->used = s->at = 0;
    s->stream = (void *)g->stream;
    s->ranks = g->ranks;
    s->multiprocessors = g->multiprocessors;
    g->stream = b->on.stream;
    g->ranks = g->ranks < RANKS ? g->ranks : (int)RANKS;
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

static void work_all(struct batch *b)
{
    struct worker *w =
        (struct worker *)calloc((size_t)b->workers, sizeof *w);
    int made = 1;
    pthread_mutex_init(&b->lock, NULL);
    pthread_cond_init(&b->turn, NULL);
    for (int k = 0; w && k < b->workers; k++) {
        w[k].batch = b;
        w[k].number = k;
    }
    pthread_mutex_lock(&b->lock); /* none starts before all are made */
    while (w && made < b->workers &&
           !pthread_create(&w[made].thread, NULL, run, &w[made]))
        made++;
    b->workers = made;
    pthread_mutex_unlock(&b->lock);
    if (w)
        run(w);
    for (int k = 1; k < made; k++)
        pthread_join(w[k].thread, NULL);
    pthread_cond_destroy(&b->turn);
    pthread_mutex_destroy(&b->lock);
    free(w);
}

int gpu_batch(struct gpu *const *g, int n, int threads,
              void (*work)(void *with, int k), void *with)
{
    struct batch b = {};
    b.seat = (struct gpu_seat **)calloc((size_t)n, sizeof *b.seat);
    bool room = b.seat != NULL;
    for (int k = 0; k < n && room; k++) {
        room = take_seat(g[k]);
        b.seat[k] = g[k]->seat;
    }
    if (room) {
        b.n = n;
        b.workers = threads < n ? threads : n;
        b.work = work;
        b.with = with;
        b.on = *g[0];
        b.on.failed = DRAPE_OK;
        for (int k = 0; k < n; k++)
            enter(&b, k);
        work_all(&b);
        for (int k = 0; k < n; k++)
            leave(b.seat[k]);
    }
    free(b.group);
    free(b.seat);
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
