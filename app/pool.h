/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that lives as long as its pool: freed all at once. */
#ifndef APP_POOL_H
#define APP_POOL_H

#include <stddef.h>

struct pool {
    struct pool_block *first; /* zero: empty */
    const double *most;       /* GB that it may hold; NULL: any number */
    double held;              /* bytes */
};

/* count × size zeroed bytes, or NULL: there is no memory, or it is more than
 * the pool may hold. The pool owns them. */
void *pool_take(struct pool *pool, size_t count, size_t size);
/* A copy of the text, or NULL. */
char *pool_text(struct pool *pool, const char *text);
void pool_free(struct pool *pool);

#endif
