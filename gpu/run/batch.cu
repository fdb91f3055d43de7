/* SPDX-License-Identifier: Apache-2.0 */
/* Advances several worlds together, for real and emulated devices.
 * gpu/run/batch.cuh */
#include "gpu/run/batch.cuh"

#include <pthread.h>
#include <stdio.h>
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
    struct kind *kind;
};

/* Launches that differ in their arguments alone can be made as one. */
struct kind {
    struct kind *next;        /* in its list of the table */
    const struct kept *like;  /* one of them */
    struct gpu_seat *waiting; /* the worlds that have it to make next */
    int heads, all;           /* so many worlds; launches that are not made */
    bool listed;              /* among the kinds that a world waits for */
};
enum { TABLE = 1 << 8 };

/* A world's place in a batch. */
struct gpu_seat {
    struct gpu *g;
    struct batch *batch;
    struct worker *worker;
    ucontext_t here;
    char *stack;
    bool over, held; /* held: launches are kept, but not made yet */
    int64_t steps;   /* begun */
    int64_t place;   /* where it waits: §11 */
    struct gpu_seat *next; /* of those that wait for the same kind */
    char *data; /* the launches that are kept, those from `at` on to be made */
    size_t used, room, at;
    int count; /* of them */
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

/* Where a world can wait, by the launches that follow, and its number in the
 * order in which the first world came there. */
struct halt {
    uint64_t hash;
    int64_t number; /* 0: none */
};
enum { HALTS = 1 << 12, FIRST_OF = 4 };

struct batch {
    struct halt halt[HALTS];
    int64_t halts;
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
    struct kind *kind, *table[TABLE], **list;
    int kinds, most_kinds, listed;
    struct group *group;
    int groups, most_groups;
    size_t staged; /* bytes of the staging memory */
};

static const struct kept *head(const struct gpu_seat *s)
{
    return s->at < s->used ? (const struct kept *)(s->data + s->at) : NULL;
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
    *one = {k, *shape, all, NULL};
    s->count++;
    memcpy(one + 1, args, k->bytes);
    s->used += all;
}

void gpu_batch_step(struct gpu *g)
{
    g->seat->steps++;
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
           s->rows == t->rows &&
           (s->kind == OF_ITEMS || s->kind == OF_PARTS ||
            s->blocks == t->blocks);
}

/* Returns the kind of a launch; NULL if there is no memory. */
static struct kind *kind_of(struct batch *b, const struct kept *k)
{
    size_t at = ((uintptr_t)k->ways >> 4) % TABLE;
    struct kind *o = b->table[at];
    while (o && !alike(o->like, k))
        o = o->next;
    if (o)
        return o;
    if (b->kinds == b->most_kinds)
        return NULL;
    o = &b->kind[b->kinds++];
    *o = {b->table[at], k, NULL, 0, 0, false};
    b->table[at] = o;
    return o;
}

/* Puts a world among those that wait for its next launch. */
static void queue(struct batch *b, struct gpu_seat *s)
{
    const struct kept *k = head(s);
    if (!k)
        return;
    struct kind *o = k->kind;
    s->next = o->waiting;
    o->waiting = s;
    o->heads++;
    if (!o->listed)
        b->list[b->listed++] = o;
    o->listed = true;
}

/* Finds the kinds of all launches. False if there is no memory. */
static bool sort_out(struct batch *b)
{
    int launches = 0;
    for (int w = 0; w < b->n; w++)
        launches += b->seat[w]->held ? 0 : b->seat[w]->count;
    if (launches > b->most_kinds) {
        free(b->kind);
        free(b->list);
        b->kind = (struct kind *)malloc((size_t)launches * sizeof *b->kind);
        b->list = (struct kind **)malloc((size_t)launches * sizeof *b->list);
        b->most_kinds = b->kind && b->list ? launches : 0;
    }
    memset(b->table, 0, sizeof b->table);
    b->kinds = b->listed = 0;
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        for (size_t at = s->held ? s->used : 0; at < s->used;) {
            struct kept *k = (struct kept *)(s->data + at);
            k->kind = kind_of(b, k);
            if (!k->kind)
                return false;
            k->kind->all++;
            at += k->bytes;
        }
    }
    for (int w = 0; w < b->n; w++)
        if (!b->seat[w]->held)
            queue(b, b->seat[w]);
    return true;
}

/* Takes the kind that is made next from the list, NULL if none is left: the one
 * that the fewest worlds have to make later. */
static struct kind *choose(struct batch *b)
{
    int best = 0;
    for (int k = 1; k < b->listed; k++) {
        const struct kind *o = b->list[k], *least = b->list[best];
        if (o->all - o->heads < least->all - least->heads)
            best = k;
    }
    if (!b->listed)
        return NULL;
    struct kind *o = b->list[best];
    b->list[best] = b->list[--b->listed];
    o->listed = false;
    return o;
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

/* Stages the launches of a kind that worlds have to make next. False if there is
 * no memory. */
static bool stage(struct batch *b, struct kind *o)
{
    size_t bytes = o->like->ways->shared_bytes;
    struct gpu_seat *s = o->waiting;
    if (!grow_groups(b) || !grow_staging(b, whole(bytes * (size_t)o->heads)))
        return false;
    struct group *all = &b->group[b->groups++];
    *all = {head(s), head(s)->shape, b->staged, o->heads};
    o->all -= o->heads;
    o->heads = 0;
    o->waiting = NULL;
    while (s) {
        struct gpu_seat *next = s->next;
        const struct kept *k = head(s);
        const struct launch_shape *t = &k->shape;
        struct launch_shape *most = &all->shape;
        char *to = b->seat[0]->host + b->staged;
        struct shared_head first = {
            t->kind == OF_PARTS ? t->blocks : INT64_MAX, 0};
        most->items = t->items > most->items ? t->items : most->items;
        most->blocks = t->blocks > most->blocks ? t->blocks : most->blocks;
        most->bytes = t->bytes > most->bytes ? t->bytes : most->bytes;
        memcpy(to, &first, sizeof first);
        memcpy(to + sizeof first, k + 1, k->ways->bytes);
        b->staged += bytes;
        s->at += k->bytes;
        queue(b, s);
        s = next;
    }
    b->staged = whole(b->staged);
    return true;
}

/* Returns the number of the halt at which a world waits. */
static int64_t halt_of(struct batch *b, const struct gpu_seat *s)
{
    uint64_t hash = 1;
    size_t at = 0;
    for (int k = 0; k < FIRST_OF && at < s->used; k++) {
        const struct kept *o = (const struct kept *)(s->data + at);
        hash = (hash ^ (uint64_t)(uintptr_t)o->ways) * 1099511628211u;
        hash ^= hash >> 29;
        at += o->bytes;
    }
    for (uint64_t k = hash; k < hash + HALTS; k++) {
        struct halt *o = &b->halt[k % HALTS];
        if (!o->number)
            *o = {hash, ++b->halts};
        if (o->hash == hash)
            return o->number;
    }
    return 0;
}

/* Holds back all worlds but those that are the least far. */
static void hold_back(struct batch *b)
{
    enum { HALTS_OF_STEP = 1 << 16 };
    int64_t least = INT64_MAX;
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        if (!s->held)
            s->place = s->steps * HALTS_OF_STEP + halt_of(b, s);
        if (!s->over && s->place < least)
            least = s->place;
    }
    for (int w = 0; w < b->n; w++)
        b->seat[w]->held = !b->seat[w]->over && b->seat[w]->place > least;
}

static double clk(void){ struct timespec t; clock_gettime(CLOCK_MONOTONIC,&t); return (double)t.tv_sec+1e-9*(double)t.tv_nsec; }
static __thread double tm[4], tlast; static __thread long cn[4];
/* Makes all launches that worlds have kept, and waits until they are done. */
static void launch_all(struct batch *b)
{
    double t0=clk(); if (tlast) tm[3]+=t0-tlast;
    const struct gpu_seat *first = b->seat[0];
    bool room = true;
    b->staged = 0;
    b->groups = 0;
    hold_back(b);
    room = sort_out(b);
    for (struct kind *k; room && (k = choose(b));)
        room = stage(b, k);
    if (!room)
        b->on.failed = DRAPE_ENOMEM;
    double t1=clk(); tm[0]+=t1-t0; cn[0]++; cn[1]+=b->groups; for (int k=0;k<b->groups;k++) cn[2]+=b->group[k].worlds;
    gpu_up_now(&b->on, first->device, first->host, b->staged);
    for (int k = 0; k < b->groups; k++) {
        const struct group *o = &b->group[k];
        gpu_launch_now(&b->on, o->first->ways, &o->shape,
                       o->worlds > 1 ? (const void *)(first->device + o->begin)
                                     : o->first + 1,
                       o->worlds);
    }
    double t2=clk(); tm[1]+=t2-t1;
    gpu_wait_now(&b->on);
    tlast=clk(); tm[2]+=tlast-t2;
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        if (!s->held)
            s->used = s->at = 0;
        s->count = s->held ? s->count : 0;
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
            if (!starting->over && !starting->held)
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
    s->over = s->held = false;
    s->steps = 0;
    s->used = s->at = 0;
    s->count = 0;
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
    static thread_local struct batch b;
    memset((void *)&b, 0, sizeof b);
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
        if (getenv("BATCH_LOG")) fprintf(stderr,"batch: flushes %ld groups %ld launches %ld; choose %.4f launch %.4f wait %.4f hosts %.4f s\n",cn[0],cn[1],cn[2],tm[0],tm[1],tm[2],tm[3]);
        memset(cn,0,sizeof cn); memset(tm,0,sizeof tm); tlast=0;
    }
    free(b.kind);
    free(b.list);
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
