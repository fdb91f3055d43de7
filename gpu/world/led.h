/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over led vertices and over displacements on the device, as in
 * ref/world/led.h. spec/world/step.md §1, §6, §7, §11 */
#ifndef GPU_LED_H
#define GPU_LED_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct blend;
struct world;

void gpu_led_pin(struct gpu *g, int64_t n, const int32_t *pinned, const vec *x,
                 vec *to);
bool gpu_led_moves(const struct world *w);
bool gpu_led_differs(struct gpu *g, int64_t n, const int32_t *at, const vec *x0,
                     const vec *x1);
void gpu_led_blend(struct gpu *g, const struct blend *s);
void gpu_led_keep(struct gpu *g, int64_t n, const uint8_t *fixed,
                  const vec *old, vec *a);
bool gpu_led_sane(struct gpu *g, int64_t n, const vec *a);
void gpu_led_velocities(struct gpu *g, int64_t n, const vec *x0, const vec *x1,
                        real dt, vec *v);
real gpu_led_furthest(struct gpu *g, int64_t n, const vec *x0, const vec *x1);
/* group [nt]: 1 for the first `cloths` triangles, else 0. */
void gpu_led_group(struct gpu *g, int64_t nt, int64_t cloths, int32_t *group);

#ifdef __cplusplus
}
#endif
#endif
