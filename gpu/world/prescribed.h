/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over prescribed vertices and over displacements on the device, as in
 * ref/base/prescribed.h. spec/world/step.md §1, §6, §7, §11 */
#ifndef GPU_PRESCRIBED_H
#define GPU_PRESCRIBED_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct blend;
struct world;

void gpu_prescribed_pin(struct gpu *g, int64_t n, const int32_t *pinned,
                        const vec *x, vec *to);
bool gpu_prescribed_moves(const struct world *w);
bool gpu_prescribed_differs(struct gpu *g, int64_t n, const int32_t *at,
                            const vec *x0, const vec *x1);
void gpu_prescribed_blend(struct gpu *g, const struct blend *s);
void gpu_prescribed_keep(struct gpu *g, int64_t n, const uint8_t *fixed,
                         const vec *old, vec *a);
bool gpu_prescribed_sane(struct gpu *g, int64_t n, const vec *a);
void gpu_prescribed_velocities(struct gpu *g, int64_t n, const vec *x0,
                               const vec *x1, real dt, vec *v);
real gpu_prescribed_furthest(struct gpu *g, int64_t n, const vec *x0,
                             const vec *x1);
/* group [nt]: 1 for the first `cloths` triangles, else 0. */
void gpu_prescribed_group(struct gpu *g, int64_t nt, int64_t cloths,
                          int32_t *group);

#ifdef __cplusplus
}
#endif
#endif
