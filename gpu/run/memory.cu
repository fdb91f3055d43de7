/* SPDX-License-Identifier: Apache-2.0 */
/* Allocates the memory of a device, real or emulated; no other file allocates
 * device memory. It works like ref/base/arena.c, but the records of blocks are
 * in host memory. spec/gpu.md §10 */
#include "gpu/run/launch.cuh"

enum { ALIGN = 256 }; /* bytes, of borrowed memory, as cudaMalloc aligns */

/* A block that was allocated, or borrowed from another block. Blocks are found
 * by address, the latest first: a borrowed block may begin where its lender
 * does. */
struct gpu_block {
    struct gpu_block *next;
    char *data;
    size_t bytes;
    char *lent; /* the part that it lends, and its bytes: multiples of ALIGN */
    size_t lent_bytes;
    enum arena_part part;
    bool borrowed;
};

/* Records that there was no memory, unless the device is lost. Returns NULL. */
static void *none(struct gpu *g)
{
    if (gpu_status(g) == DRAPE_OK)
        g->failed = DRAPE_ENOMEM;
    return NULL;
}

static size_t round_up(size_t bytes)
{
    return (bytes + ALIGN - 1) / ALIGN * ALIGN;
}

/* Makes a block. data: where borrowed memory lies; NULL: memory is allocated,
 * and not zeroed. Returns the memory, or NULL. */
static void *take(struct gpu *g, enum arena_part part, size_t bytes, char *data)
{
    struct gpu_block *b =
        (struct gpu_block *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *b);
    if (!b)
        return none(g);
    b->borrowed = data != NULL;
    g->taken += !data;
    b->data = data ? data : (char *)g->device.allocate(g->device.user, bytes);
    if (!b->data) {
        arena_give(&g->host, b);
        return none(g);
    }
    b->bytes = bytes;
    b->part = part;
    b->next = g->blocks;
    g->blocks = b;
    *(data ? &g->borrowed : &g->bytes[part]) += bytes;
    return b->data;
}

void *gpu_take(struct gpu *g, enum arena_part part, int64_t count, size_t size)
{
    size_t n = (size_t)(count > 0 ? count : 0);
    void *p =
        n > SIZE_MAX / size ? none(g) : take(g, part, n * size + !n, NULL);
    if (p)
        gpu_clear(g, p, n * size);
    return p;
}

/* Every growth costs a wait for the device, however few items it is of. */
int64_t gpu_capacity(const struct gpu *g, int64_t need)
{
    const int64_t few = 1 << 14;
    int64_t more = need / 4 + (need < few ? need : few) + 1024;
    return g->tight ? need : need + more;
}

void *gpu_take_copy(struct gpu *g, enum arena_part part, const void *host,
                    int64_t count, size_t size)
{
    void *p = gpu_take(g, part, count, size);
    if (p && host)
        gpu_up(g, p, host, (size_t)count * size);
    return p;
}

void gpu_lend(struct gpu *g, void *p, size_t bytes)
{
    char *from = (char *)p;
    size_t skip = round_up((size_t)(uintptr_t)from) - (size_t)(uintptr_t)from;
    for (struct gpu_block *b = g->blocks; b; b = b->next)
        if (b->data <= from && from + bytes <= b->data + b->bytes &&
            bytes > skip) {
            b->lent = from + skip;
            b->lent_bytes = (bytes - skip) / ALIGN * ALIGN;
            return;
        }
}

/* Returns the first free bytes in the part that b lends, or NULL. */
static char *gap(const struct gpu *g, const struct gpu_block *b, size_t bytes)
{
    char *at = b->lent, *end = at + b->lent_bytes;
    const struct gpu_block *o = g->blocks;
    while (o && bytes <= (size_t)(end - at)) {
        bool meets = o->borrowed && o->data < at + bytes &&
                     at < o->data + round_up(o->bytes);
        at = meets ? o->data + round_up(o->bytes) : at;
        o = meets ? g->blocks : o->next;
    }
    return o ? NULL : at;
}

/* Borrows the bytes from the first gap that is large enough, or else allocates
 * them. */
static void *borrow(struct gpu *g, enum arena_part part, size_t bytes)
{
    char *at = NULL;
    for (const struct gpu_block *b = g->blocks; b && !at; b = b->next)
        at = b->lent ? gap(g, b, bytes) : NULL;
    return take(g, part, bytes, at);
}

void *gpu_borrow(struct gpu *g, enum arena_part part, int64_t count,
                 size_t size)
{
    size_t n = (size_t)(count > 0 ? count : 0);
    return n > SIZE_MAX / size ? none(g) : borrow(g, part, n * size + !n);
}

void gpu_hand_over(struct gpu *g)
{
#ifndef __CUDACC__
    gpu_wait(g);
    for (struct gpu_block *b = g->blocks; b && !g->failed; b = b->next)
        if (b->lent)
            memset(b->lent, 0xff, b->lent_bytes);
#else
    (void)g;
#endif
}

void gpu_give(struct gpu *g, void *p)
{
    for (struct gpu_block **at = &g->blocks; p && *at; at = &(*at)->next)
        if ((*at)->data == p) {
            struct gpu_block *b = *at;
            *at = b->next;
            *(b->borrowed ? &g->borrowed : &g->bytes[b->part]) -= b->bytes;
            if (!b->borrowed) {
                gpu_wait(g);
                g->device.release(g->device.user, p, b->bytes);
            }
            arena_give(&g->host, b);
            return;
        }
}

struct gpu *gpu_make(const drape_def *def, const drape_allocator *native)
{
    struct arena arena;
    const drape_def plain = {};
    def = def ? def : &plain;
    arena_init(&arena, &def->allocator);
    struct gpu *g = (struct gpu *)arena_take(&arena, ARENA_OTHER, 1, sizeof *g);
    if (!g)
        return NULL;
    g->host = arena;
    g->device =
        def->device_allocator.allocate ? def->device_allocator : *native;
    g->block = def->block ? def->block : GPU_BLOCK;
    return g;
}

void gpu_unmake(struct gpu *g)
{
    while (g->blocks)
        gpu_give(g, g->blocks->data);
    struct arena arena = g->host; /* g itself lies in this arena */
    arena_free(&arena);
}

void *gpu_scratch(struct gpu *g, int slot, int64_t count, size_t size)
{
    struct gpu_slot *s = &g->slot[slot];
    size_t bytes = (size_t)count * size + 1;
    if (bytes <= s->bytes)
        return s->data;
    gpu_give(g, s->data);
    bytes += s->bytes ? bytes / 4 : 0; /* so that growth is rare */
    s->data = slot == SLOT_SOLVE ? take(g, ARENA_SCRATCH, bytes, NULL)
                                 : borrow(g, ARENA_SCRATCH, bytes);
    s->bytes = s->data ? bytes : 0;
    return s->data;
}

void *gpu_aside(struct gpu *g, size_t bytes)
{
    struct gpu_slot *s = &g->aside;
    if (bytes <= s->bytes && s->data)
        return s->data;
    arena_give(&g->host, s->data);
    s->data = arena_take(&g->host, ARENA_OTHER, (int64_t)bytes, 1);
    s->bytes = s->data ? bytes : 0;
    return s->data ? s->data : none(g);
}

int gpu_device(const struct gpu *g)
{
    return g->number;
}

void *gpu_stream(const struct gpu *g)
{
    return g->stream;
}

const char *gpu_name(const struct gpu *g)
{
    return g->name;
}

void gpu_set_hosted(struct gpu *g)
{
    g->hosted[1] = true;
}

void gpu_set_block(struct gpu *g, int threads)
{
    g->block = threads;
}

const size_t *gpu_held(const struct gpu *g)
{
    return g->bytes;
}

void gpu_count(const struct gpu *g, drape_memory *m)
{
    for (int k = 0; k < ARENA_PARTS; k++) {
        m->host_bytes += g->host.bytes[k];
        m->device_bytes += g->bytes[k];
    }
    m->borrowed_bytes += g->borrowed;
    m->host_allocations += g->host.taken;
    m->device_allocations += g->taken;
}
