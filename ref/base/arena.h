/* SPDX-License-Identifier: Apache-2.0 */
/* Memory of a world: the only place that allocates. Everything is released
 * at once; a stream that must grow is replaced. Counted by part. */
#ifndef REF_ARENA_H
#define REF_ARENA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "spec/drape.h"

/* Whose memory it is, as the plan reports it. */
enum arena_part {
    ARENA_STATE,
    ARENA_CLOTH,
    ARENA_OBSTACLE,
    ARENA_SOLVER,
    ARENA_TREE,
    ARENA_FRONT,
    ARENA_PAIRS,
    ARENA_RESPONSE,
    ARENA_SCRATCH, /* of a device's stages; the reference's is in the others */
    ARENA_OTHER,
    ARENA_PARTS
};

struct arena {
    drape_allocator allocator;
    struct arena_block *blocks;
    size_t bytes[ARENA_PARTS]; /* held now */
    int64_t taken;             /* how often something was */
    bool failed;               /* an allocation gave nothing since create */
};

void arena_init(struct arena *a, const drape_allocator *allocator);
/* Zeroed, aligned to 64 bytes; NULL and a->failed where there is none. */
void *arena_take(struct arena *a, enum arena_part part, int64_t count,
                 size_t size);
void arena_give(struct arena *a, void *p); /* back; NULL is allowed */
void arena_free(struct arena *a);

#endif
