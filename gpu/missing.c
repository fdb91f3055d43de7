/* SPDX-License-Identifier: Apache-2.0 */
/* Stages that are not on the device yet. */
#include "gpu/stages.h"

#define MISSING(X)                                                             \
    int gpu_##X(struct gpu *g, struct X *s)                                    \
    {                                                                          \
        (void)g;                                                               \
        (void)s;                                                               \
        return DRAPE_EDEVICE;                                                  \
    }
MISSING(audit)
