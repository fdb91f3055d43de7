/* SPDX-License-Identifier: Apache-2.0 */
/* See tests/world/recall.h. */
#include "tests/world/recall.h"

#include "ref/world/checkpoint.h"

int recall_write(void *user, const void *data, size_t bytes)
{
    struct recall *r = user;
    if (bytes > sizeof r->data - r->size)
        return 1;
    if (bytes)
        memcpy(r->data + r->size, data, bytes);
    r->size += bytes;
    return 0;
}

int recall_read(void *user, void *data, size_t bytes)
{
    struct recall *r = user;
    if (bytes > r->size - r->at)
        return 1;
    if (bytes)
        memcpy(data, r->data + r->at, bytes);
    r->at += bytes;
    return 0;
}

bool recall_save(const drape_world *world, struct recall *r)
{
    r->size = 0;
    return drape_save(world, recall_write, r) == DRAPE_OK;
}

int recall_load(drape_world *world, struct recall *r)
{
    r->at = 0;
    return drape_load(world, recall_read, r);
}

bool recall_save_inner(const struct world *world, struct recall *r)
{
    r->size = 0;
    return checkpoint_save(world, recall_write, r) == DRAPE_OK;
}

int recall_load_inner(struct world *world, struct recall *r)
{
    r->at = 0;
    return checkpoint_load(world, recall_read, r);
}

bool recall_same(const struct recall *a, const struct recall *b)
{
    return a->size == b->size && !memcmp(a->data, b->data, a->size);
}
