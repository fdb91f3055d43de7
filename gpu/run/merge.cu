/* SPDX-License-Identifier: Apache-2.0 */
/* Keeps launches of several problems until they can be merged, for real and
 * emulated devices. gpu/run/merge.cuh */
#include "gpu/run/merge.cuh"

/* A launch that is kept; its arguments follow it. */
struct kept {
    const struct merge_ways *ways;
    struct launch_shape shape;
    size_t bytes; /* of this struct and the arguments, rounded up */
};

static const struct kept *after(const struct kept *k)
{
    return (const struct kept *)((const char *)k + k->bytes);
}

/* What is kept: the launches of one problem after another, problem k from byte
 * begin[k] on. */
struct gpu_merge {
    char *data;
    size_t used, room, begin[MERGE_MOST + 1];
    int problems;
};

enum { ALIGNED = 16, FIRST_ROOM = 1 << 16 };

void gpu_merge_open(struct gpu *g)
{
    g->merge = (struct gpu_merge *)arena_take(&g->host, ARENA_OTHER, 1,
                                              sizeof *g->merge);
}

void gpu_merge_next(struct gpu *g)
{
    struct gpu_merge *m = g->merge;
    if (m)
        m->begin[m->problems++] = m->used;
}

/* Makes room for so many bytes. False if there is no memory. */
static bool grow(struct gpu *g, struct gpu_merge *m, size_t bytes)
{
    size_t room = m->room ? 2 * m->room : (size_t)FIRST_ROOM;
    if (m->used + bytes <= m->room)
        return true;
    while (room < m->used + bytes)
        room *= 2;
    char *data = (char *)arena_take(&g->host, ARENA_OTHER, (int64_t)room, 1);
    if (!data)
        return false;
    if (m->used)
        memcpy(data, m->data, m->used);
    arena_give(&g->host, m->data);
    m->data = data;
    m->room = room;
    return true;
}

void gpu_merge_add(struct gpu *g, const struct merge_ways *ways,
                   const struct launch_shape *s, const void *args)
{
    struct gpu_merge *m = g->merge;
    size_t bytes = ways->alone->bytes;
    size_t all =
        (sizeof(struct kept) + bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
    if (!m) {
        gpu_launch(g, ways->alone, s, args);
        return;
    }
    if (!grow(g, m, all)) {
        g->failed = g->failed ? g->failed : (int)DRAPE_ENOMEM;
        return;
    }
    struct kept *k = (struct kept *)(m->data + m->used);
    *k = {ways, *s, all};
    memcpy(k + 1, args, bytes);
    m->used += all;
}

/* Whether two launches differ in their arguments alone. */
static bool alike(const struct kept *a, const struct kept *b)
{
    const struct launch_shape *s = &a->shape, *t = &b->shape;
    return a->ways == b->ways && s->items == t->items &&
           s->blocks == t->blocks && s->bytes == t->bytes &&
           s->threads == t->threads;
}

/* The first launch of problem k; of one behind the last, where they end. */
static const struct kept *first_of(const struct gpu_merge *m, int k)
{
    return (const struct kept *)(m->data + m->begin[k]);
}

/* Whether all problems make the same launches. */
static bool mergeable(const struct gpu_merge *m)
{
    size_t bytes = m->begin[1] - m->begin[0];
    for (int k = 1; k < m->problems; k++) {
        const struct kept *a = first_of(m, 0), *b = first_of(m, k);
        if (m->begin[k + 1] - m->begin[k] != bytes)
            return false;
        for (; a != first_of(m, 1); a = after(a), b = after(b))
            if (!alike(a, b))
                return false;
    }
    return true;
}

static void launch_all(struct gpu *g, const struct gpu_merge *m)
{
    const struct kept *k = first_of(m, 0);
    for (; k != first_of(m, m->problems); k = after(k)) {
        gpu_launch(g, k->ways->alone, &k->shape, k + 1);
    }
}

static void launch_rows(struct gpu *g, const struct gpu_merge *m)
{
    const struct kept *first = first_of(m, 0);
    for (; first != first_of(m, 1); first = after(first)) {
        const void *args[MERGE_MOST];
        size_t from = (size_t)((const char *)first - m->data);
        for (int k = 0; k < m->problems; k++)
            args[k] = m->data + m->begin[k] + from + sizeof *first;
        first->ways->merged(g, &first->shape, args, m->problems);
    }
}

void gpu_merge_close(struct gpu *g)
{
    struct gpu_merge *m = g->merge;
    g->merge = NULL;
    if (!m)
        return;
    m->begin[m->problems] = m->used;
    if (m->used && !g->failed) {
        if (m->problems > 1 && mergeable(m))
            launch_rows(g, m);
        else
            launch_all(g, m);
    }
    arena_give(&g->host, m->data);
    arena_give(&g->host, m);
}
