/* SPDX-License-Identifier: Apache-2.0 */
/* Stages that are not on the device yet. */
#include "gpu/world.h"

#define MISSING(X)                                                             \
    int gpu_##X(struct gpu *g, struct X *s)                                    \
    {                                                                          \
        (void)g;                                                               \
        (void)s;                                                               \
        return DRAPE_EDEVICE;                                                  \
    }
MISSING(audit)

/* ---- Parts of the pipeline, gpu/world.h ---- */

#define UNUSED(a) (void)(a)

int gpu_broad_make(struct gpu *g, const struct broad *host, struct broad *b)
{
    UNUSED(g);
    UNUSED(host);
    UNUSED(b);
    return DRAPE_EDEVICE;
}

int gpu_broad_query(struct gpu *g, struct broad *b, const vec *x0,
                    const vec *x1, real r, const uint8_t *moved)
{
    UNUSED(g);
    UNUSED(b);
    UNUSED(x0);
    UNUSED(x1);
    UNUSED(r);
    UNUSED(moved);
    return DRAPE_EDEVICE;
}
