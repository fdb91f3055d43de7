/* SPDX-License-Identifier: Apache-2.0 */
/* Makes launches of several worlds as one. gpu/run/batch.cuh */
#include <pthread.h>
#include <stdlib.h>

#include "gpu/run/batch.cuh"

enum { ALIGNED = 16, FIRST_ROOM = 1 << 13, FIRST_GROUPS = 64 };

/* A launch that is kept; its arguments follow it. */
struct kept {
    const struct kernel_ways *ways;
    struct launch_shape shape;
    size_t bytes; /* of this struct and the arguments, rounded up */
    struct kind *kind;
};

/* Launches that can be made as one: they differ in their arguments, and where
 * that does no harm in the number of their blocks. */
struct kind {
    struct kind *next;        /* in its list of the table */
    const struct kept *like;  /* one of them */
    struct gpu_seat *waiting; /* the worlds that have it to make next */
    int heads, all;           /* so many worlds; launches that are not made */
    bool waited;              /* it is in the list of kinds with such worlds */
};

/* Launches that are made as one. */
struct group {
    const struct kept *first;
    struct launch_shape shape;
    size_t begin; /* byte of their arguments in the staging memory */
    int worlds;
};

static size_t round_up(size_t bytes)
{
    return (bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
}

/* Returns the launch that a world makes next, or NULL. */
static struct kept *head(const struct gpu_seat *s)
{
    return s->at < s->used ? (struct kept *)(s->data + s->at) : NULL;
}

/* Makes room for so many bytes of launches. False if there is no memory. */
static bool grow(struct gpu_seat *s, size_t bytes)
{
    size_t room = s->room ? s->room : (size_t)FIRST_ROOM;
    if (s->used + bytes <= s->room)
        return true;
    while (room < s->used + bytes)
        room *= 2;
    char *data = (char *)arena_take(&s->g->host, ARENA_OTHER, (int64_t)room, 1);
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
    size_t all = round_up(sizeof(struct kept) + k->bytes);
    if (!grow(s, all)) {
        g->failed = DRAPE_ENOMEM;
        return;
    }
    struct kept *one = (struct kept *)(s->data + s->used);
    *one = {k, *shape, all, NULL};
    memcpy(one + 1, args, k->bytes);
    s->used += all;
    s->count++;
}

/* Returns the number of the halt at which a world waits, by the first launches
 * that it has kept. */
static int64_t halt_of(struct batch *b, const struct gpu_seat *s)
{
    enum { FIRST = 4 };
    uint64_t hash = 1;
    size_t at = 0;
    for (int k = 0; k < FIRST && at < s->used; k++) {
        const struct kept *o = (const struct kept *)(s->data + at);
        hash = (hash ^ (uint64_t)(uintptr_t)o->ways) * 0x100000001b3;
        hash ^= hash >> 29;
        at += o->bytes;
    }
    for (uint64_t k = 0; k < HALTS; k++) {
        struct halt *o = &b->halt[(hash + k) % HALTS];
        if (!o->number)
            *o = {hash, ++b->halts};
        if (o->hash == hash)
            return o->number;
    }
    return 0;
}

/* Holds back all worlds but those that are the least far: those of the earliest
 * step, and of them those at the halt with the lowest number. So the worlds
 * that are behind catch up, and more of them have the same launches to make. */
static void hold_back(struct batch *b)
{
    enum { MOST_HALTS = 2 * HALTS };
    int64_t least = INT64_MAX;
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        if (!s->held)
            s->halt = s->steps * MOST_HALTS + halt_of(b, s);
        if (!s->over && s->halt < least)
            least = s->halt;
    }
    for (int w = 0; w < b->n; w++)
        b->seat[w]->held = !b->seat[w]->over && b->seat[w]->halt > least;
}

static bool alike(const struct kept *a, const struct kept *b)
{
    const struct launch_shape *s = &a->shape, *t = &b->shape;
    return a->ways == b->ways && s->threads == t->threads &&
           s->rows == t->rows &&
           (s->kind == OF_ITEMS || s->kind == OF_PARTS ||
            s->blocks == t->blocks);
}

/* Returns the kind of a launch. */
static struct kind *kind_of(struct batch *b, const struct kept *k)
{
    size_t at = ((uintptr_t)k->ways / ALIGNED) % KINDS;
    struct kind *o = b->table[at];
    while (o && !alike(o->like, k))
        o = o->next;
    if (o)
        return o;
    o = &b->kind[b->kinds++];
    *o = {b->table[at], k, NULL, 0, 0, false};
    b->table[at] = o;
    return o;
}

/* Puts a world among those that wait for the launch that it makes next. */
static void queue(struct batch *b, struct gpu_seat *s)
{
    const struct kept *k = head(s);
    if (!k)
        return;
    s->next = k->kind->waiting;
    k->kind->waiting = s;
    k->kind->heads++;
    if (!k->kind->waited)
        b->waited[b->waits++] = k->kind;
    k->kind->waited = true;
}

/* Makes room for so many kinds. False if there is no memory. */
static bool grow_kinds(struct batch *b, int kinds)
{
    if (kinds <= b->most_kinds)
        return true;
    free(b->kind);
    free(b->waited);
    b->kind = (struct kind *)malloc((size_t)kinds * sizeof *b->kind);
    b->waited = (struct kind **)malloc((size_t)kinds * sizeof *b->waited);
    b->most_kinds = b->kind && b->waited ? kinds : 0;
    return b->most_kinds > 0;
}

/* Finds the kinds of all launches that are made now. False if there is no
 * memory. */
static bool sort_out(struct batch *b)
{
    int launches = 0;
    for (int w = 0; w < b->n; w++)
        launches += b->seat[w]->held ? 0 : b->seat[w]->count;
    memset(b->table, 0, sizeof b->table);
    b->kinds = b->waits = 0;
    if (!grow_kinds(b, launches))
        return false;
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        for (size_t at = s->held ? s->used : 0; at < s->used;) {
            struct kept *k = (struct kept *)(s->data + at);
            k->kind = kind_of(b, k);
            k->kind->all++;
            at += k->bytes;
        }
    }
    for (int w = 0; w < b->n; w++)
        if (!b->seat[w]->held)
            queue(b, b->seat[w]);
    return true;
}

/* Returns the kind that is made next, NULL if none is left: the one of which
 * the fewest launches come later. */
static struct kind *choose(struct batch *b)
{
    int best = 0;
    for (int k = 1; k < b->waits; k++) {
        const struct kind *o = b->waited[k], *least = b->waited[best];
        if (o->all - o->heads < least->all - least->heads)
            best = k;
    }
    if (!b->waits)
        return NULL;
    struct kind *o = b->waited[best];
    b->waited[best] = b->waited[--b->waits];
    o->waited = false;
    return o;
}

/* Makes room for so many bytes of staging memory; what is staged stays. False
 * if there is no memory. */
static bool grow_staging(struct batch *b, size_t bytes)
{
    struct gpu_seat *s = b->seat[0];
    size_t room = 2 * (b->staged + bytes);
    if (b->staged + bytes <= s->staging)
        return true;
    s->g->together = false; /* its memory is taken at once */
    char *host = (char *)gpu_pin(s->g, room);
    char *device = (char *)gpu_take(s->g, ARENA_SCRATCH, (int64_t)room, 1);
    bool enough = host && device;
    if (enough && b->staged)
        memcpy(host, s->host, b->staged);
    gpu_unpin(s->g, enough ? s->host : host);
    gpu_give(s->g, enough ? s->device : device);
    if (enough) {
        s->host = host;
        s->device = device;
        s->staging = room;
    }
    s->g->together = true;
    return enough;
}

/* Makes room for one more group. False if there is no memory. */
static bool grow_groups(struct batch *b)
{
    int most = b->most_groups ? 2 * b->most_groups : (int)FIRST_GROUPS;
    if (b->groups < b->most_groups)
        return true;
    void *all = realloc(b->group, (size_t)most * sizeof *b->group);
    if (!all)
        return false;
    b->group = (struct group *)all;
    b->most_groups = most;
    return true;
}

/* Adds the launch that a world makes next to a group. */
static void join(struct batch *b, struct group *o, struct gpu_seat *s)
{
    const struct kept *k = head(s);
    const struct launch_shape *t = &k->shape;
    struct launch_shape *most = &o->shape;
    char *to = b->seat[0]->host + b->staged;
    struct world_head first = {t->kind == OF_PARTS ? t->blocks : INT64_MAX, 0};
    most->items = t->items > most->items ? t->items : most->items;
    most->blocks = t->blocks > most->blocks ? t->blocks : most->blocks;
    most->bytes = t->bytes > most->bytes ? t->bytes : most->bytes;
    memcpy(to, &first, sizeof first);
    memcpy(to + sizeof first, k + 1, k->ways->bytes);
    b->staged += k->ways->world_bytes;
    s->at += k->bytes;
}

/* Makes a group of the launches of a kind that worlds make next. False if there
 * is no memory. */
static bool stage(struct batch *b, struct kind *o)
{
    struct gpu_seat *s = o->waiting;
    size_t bytes = (size_t)o->heads * o->like->ways->world_bytes;
    if (!grow_groups(b) || !grow_staging(b, bytes))
        return false;
    struct group *all = &b->group[b->groups++];
    *all = {head(s), head(s)->shape, b->staged, o->heads};
    o->all -= o->heads;
    o->heads = 0;
    o->waiting = NULL;
    while (s) {
        struct gpu_seat *next = s->next;
        join(b, all, s);
        queue(b, s);
        s = next;
    }
    return true;
}

/* Launches all groups, and waits. */
static void launch_groups(struct batch *b)
{
    const struct gpu_seat *first = b->seat[0];
    gpu_up_now(&b->on, first->device, first->host, b->staged);
    for (int k = 0; k < b->groups; k++) {
        const struct group *o = &b->group[k];
        const void *alone = o->first + 1, *all = first->device + o->begin;
        gpu_launch_now(&b->on, o->first->ways, &o->shape,
                       o->worlds > 1 ? all : alone, o->worlds);
    }
    gpu_wait_now(&b->on);
}

/* Tells all worlds of a failure, which may be the loss of the device. */
static void tell_failure(struct batch *b)
{
    for (int w = 0; w < b->n; w++) {
        struct gpu *g = b->seat[w]->g;
        if (!g->failed)
            memcpy(g->name, b->on.name, sizeof g->name);
        g->failed = g->failed ? g->failed : b->on.failed;
    }
    if (b->on.failed == DRAPE_ENOMEM)
        b->on.failed = DRAPE_OK;
}

void gpu_batch_launch(struct batch *b)
{
    b->staged = 0;
    b->groups = 0;
    hold_back(b);
    bool room = sort_out(b);
    for (struct kind *k; room && (k = choose(b));)
        room = stage(b, k);
    if (!room)
        b->on.failed = b->on.failed ? b->on.failed : (int)DRAPE_ENOMEM;
    launch_groups(b);
    for (int w = 0; w < b->n; w++) {
        struct gpu_seat *s = b->seat[w];
        if (s->held)
            continue;
        s->used = s->at = 0;
        s->count = 0;
    }
    if (b->on.failed)
        tell_failure(b);
}
