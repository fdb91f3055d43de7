/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's motion on the device: ref/cloth/motion.h.
 * spec/cloth/dynamics.md */
#ifndef GPU_MOTION_H
#define GPU_MOTION_H

#include "gpu/cloth/sheet.h"
#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How many streams of vec work has on the device, where star and b of an
 * implicit method lie elsewhere. */
static inline int64_t motion_vecs(const struct dynamics *d)
{
    int64_t apart = dynamics_implicit(d->method) ? 2 : 0;
    return dynamics_vecs(d->method) - apart;
}

/* Streams of vec that an explicit method has in addition. */
static inline int64_t motion_spares(const struct dynamics *d)
{
    return d->method == DRAPE_RK4 ? 1 : 0;
}

#ifdef __cplusplus
}
#endif
#endif
