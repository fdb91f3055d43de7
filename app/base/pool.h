/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that lives as long as its pool: freed all at once. */
#ifndef APP_BASE_POOL_H
#define APP_BASE_POOL_H

#include <stddef.h>

struct pool {
    struct pool_block *first; /* NULL: the pool is empty */
    const double *most;       /* GB, its limit; NULL: no limit */
    double held;              /* bytes */
};

/* Returns count × size zeroed bytes, owned by the pool; NULL if there is no
 * memory or the limit is exceeded. */
void *pool_take(struct pool *pool, size_t count, size_t size);
/* Returns a copy of the text, or NULL. */
char *pool_text(struct pool *pool, const char *text);
/* Returns a copy of a path's last name without its ending, or NULL. */
char *pool_stem(struct pool *pool, const char *path);
void pool_free(struct pool *pool);

#endif
