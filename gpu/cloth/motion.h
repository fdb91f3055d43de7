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

/* ref_motion, ref_motion_part and motion_energy on the device. All but parts
 * other than MOTION_END wait for it. part: enum motion_part. */
int gpu_motion(struct gpu *g, struct sheet *s);
int gpu_motion_part(struct gpu *g, struct sheet *s, int part);
void gpu_motion_energy(struct gpu *g, struct sheet *s, const vec *x,
                       const vec *v, double value[3]);

/* Copies the laws and triples of the cloth, which have changed on the host, to
 * the device. */
void gpu_motion_laws(struct gpu *g, struct sheet *s);

#ifdef __cplusplus
}
#endif
#endif
