/* SPDX-License-Identifier: Apache-2.0 */
/* The memory of a world; see ref/base/arena.h. */
#include "ref/base/arena.h"

#include <stdlib.h>
#include <string.h>

/* The header in front of each stream. It occupies HEADER bytes, which is also
 * the alignment of streams. The headers form one doubly linked list. */
struct arena_block {
    struct arena_block *next, *prev;
    size_t bytes; /* of the stream, without the header */
    enum arena_part part;
};
enum { HEADER = 64 };

static void *default_allocate(void *user, size_t bytes)
{
    (void)user;
    return aligned_alloc(HEADER, (bytes + HEADER - 1) / HEADER * HEADER);
}

static void default_release(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(p);
}

void arena_init(struct arena *a, const drape_allocator *allocator)
{
    memset(a, 0, sizeof *a);
    a->allocator = *allocator;
    if (!a->allocator.allocate) {
        a->allocator.allocate = default_allocate;
        a->allocator.release = default_release;
    }
}

static void link_block(struct arena *a, struct arena_block *b)
{
    b->prev = NULL;
    b->next = a->blocks;
    if (b->next)
        b->next->prev = b;
    a->blocks = b;
    a->bytes[b->part] += b->bytes;
}

static void unlink_block(struct arena *a, struct arena_block *b)
{
    if (b->prev)
        b->prev->next = b->next;
    else
        a->blocks = b->next;
    if (b->next)
        b->next->prev = b->prev;
    a->bytes[b->part] -= b->bytes;
}

static struct arena_block *block_of(void *p)
{
    return (struct arena_block *)(void *)((uint8_t *)p - HEADER);
}

void *arena_take(struct arena *a, enum arena_part part, int64_t count,
                 size_t size)
{
    size_t n = (size_t)(count > 0 ? count : 1);
    if (n > (SIZE_MAX - HEADER) / size) {
        a->failed = true;
        return NULL;
    }
    a->taken++;
    uint8_t *p = a->allocator.allocate(a->allocator.user, HEADER + n * size);
    if (!p) {
        a->failed = true;
        return NULL;
    }
    struct arena_block *b = (struct arena_block *)(void *)p;
    b->bytes = n * size;
    b->part = part;
    link_block(a, b);
    memset(p + HEADER, 0, b->bytes);
    return p + HEADER;
}

void arena_give(struct arena *a, void *p)
{
    if (!p)
        return;
    struct arena_block *b = block_of(p);
    unlink_block(a, b);
    a->allocator.release(a->allocator.user, b, HEADER + b->bytes);
}

void arena_free(struct arena *a)
{
    while (a->blocks)
        arena_give(a, (uint8_t *)a->blocks + HEADER);
}

void arena_set_aside(struct arena *a, struct arena *aside)
{
    *aside = *a;
    a->blocks = NULL;
    memset(a->bytes, 0, sizeof a->bytes);
}

void arena_move(struct arena *from, struct arena *to, void *p)
{
    struct arena_block *b = block_of(p);
    unlink_block(from, b);
    link_block(to, b);
}

void arena_put_back(struct arena *a, struct arena *aside)
{
    a->blocks = aside->blocks;
    memcpy(a->bytes, aside->bytes, sizeof a->bytes);
}
