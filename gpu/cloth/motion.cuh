/* SPDX-License-Identifier: Apache-2.0 */
/* What both halves of a cloth's motion on the device use.
 * spec/cloth/dynamics.md */
#ifndef GPU_MOTION_CUH
#define GPU_MOTION_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "gpu/cloth/motion.h"
#include "gpu/run/backend.h"
}

/* Stream k of work. */
static inline vec *motion_stream(const struct sheet *s, int k)
{
    return s->dynamics.work + k * s->cloth.count;
}

static inline void motion_trace(struct gpu *g, const struct sheet *s,
                                const char *stage, const vec *out)
{
    gpu_trace(g, s->dynamics.trace, stage, out,
              (size_t)s->cloth.count * sizeof *out);
}

/* Stream 0 of work: the force at x; wind at v, the springs damp at damping,
 * or do not where that is NULL. */
void gpu_motion_force(struct gpu *g, struct sheet *s, const vec *x,
                      const vec *v, const vec *damping);

/* The stage that makes it, behind the wind's. */
struct springs gpu_motion_springs(struct gpu *g, struct sheet *s, const vec *x,
                                  const vec *v, const vec *damping);

/* x1 = x, v1 = v. */
void gpu_motion_copy(struct gpu *g, struct sheet *s, const vec *x,
                     const vec *v);

/* Substeps of the method from x, v to x1, v1. DRAPE_OK or DRAPE_ELIMIT. */
int gpu_motion_explicit(struct gpu *g, struct sheet *s);

/* bounded_keeps on the device: sets the energies at the start and the end of
 * the step. Waits for the device. */
bool gpu_motion_bounded(struct gpu *g, struct sheet *s);

#endif
