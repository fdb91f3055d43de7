/* SPDX-License-Identifier: Apache-2.0 */
/* The allocator of a world, and the only place in ref/ that allocates. Streams
 * are zeroed, aligned, and counted by part. All of them are released together;
 * a stream that must grow is replaced by a larger one. */
#ifndef REF_ARENA_H
#define REF_ARENA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "spec/drape.h"

/* What a stream is used for; the plan reports bytes by part. */
enum arena_part {
    ARENA_STATE,
    ARENA_CLOTH,
    ARENA_OBSTACLE,
    ARENA_SOLVER,
    ARENA_TREE,
    ARENA_FRONT,
    ARENA_PAIRS,
    ARENA_RESPONSE,
    ARENA_SCRATCH, /* of the device's stages; the reference counts scratch in
                      the other parts */
    ARENA_OTHER,
    ARENA_PARTS
};

struct arena {
    drape_allocator allocator;
    struct arena_block *blocks;
    size_t bytes[ARENA_PARTS]; /* held now, without headers */
    int64_t taken;             /* allocations tried since arena_init */
    bool failed;               /* an allocation has failed; the caller resets
                                  it */
};

void arena_init(struct arena *a, const drape_allocator *allocator);
/* Returns a zeroed stream of count items of `size` bytes, aligned to 64 bytes.
 * If there is no memory, returns NULL and sets a->failed. */
void *arena_take(struct arena *a, enum arena_part part, int64_t count,
                 size_t size);
void arena_give(struct arena *a, void *p); /* releases one stream, or NULL */
void arena_free(struct arena *a);

/* Moves all streams of a to `aside`, which becomes an arena of the same
 * allocator. */
void arena_set_aside(struct arena *a, struct arena *aside);
/* Moves one stream from an arena to another of the same allocator. */
void arena_move(struct arena *from, struct arena *to, void *p);
/* Moves all streams that were set aside back to a, which has none. */
void arena_put_back(struct arena *a, struct arena *aside);

#endif
