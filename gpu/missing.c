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
MISSING(matrix)
MISSING(product)
MISSING(jacobi)
MISSING(excess)
MISSING(coarsen)
MISSING(multigrid)
MISSING(pcg)
MISSING(refit)
MISSING(cones)
MISSING(front)
MISSING(walk)
MISSING(features)
MISSING(narrow)
MISSING(audit)
MISSING(impacts)
MISSING(impulses)
MISSING(contacts)
MISSING(penalty)
MISSING(zones)
MISSING(rollback)
