/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that lives as long as its pool. */
#include "app/base/pool.h"

#include <stdlib.h>
#include <string.h>

struct pool_block {
    struct pool_block *next;
    max_align_t data[];
};

void *pool_take(struct pool *pool, size_t count, size_t size)
{
    if (size && count > ((size_t)-1 - sizeof(struct pool_block)) / size)
        return NULL;
    double held = pool->held + (double)count * (double)size;
    if (pool->most && held > *pool->most * 1e9)
        return NULL;
    struct pool_block *block =
        calloc(1, sizeof(struct pool_block) + count * size);
    if (!block)
        return NULL;
    block->next = pool->first;
    pool->first = block;
    pool->held = held;
    return block->data;
}

char *pool_text(struct pool *pool, const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = pool_take(pool, size, 1);
    return copy ? memcpy(copy, text, size) : NULL;
}

char *pool_stem(struct pool *pool, const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = pool_text(pool, slash ? slash + 1 : path);
    char *dot = name ? strrchr(name, '.') : NULL;
    if (dot && dot != name)
        *dot = 0;
    return name;
}

void pool_free(struct pool *pool)
{
    while (pool->first) {
        struct pool_block *next = pool->first->next;
        free(pool->first);
        pool->first = next;
    }
    pool->held = 0;
}
