/* SPDX-License-Identifier: Apache-2.0 */
/* Loops for waking cloths on the device, as in ref/sleep/wake.h.
 * spec/sleep/sleep.md */
#ifndef GPU_WAKE_H
#define GPU_WAKE_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct wake;

void gpu_wake_find(struct gpu *g, const struct wake *s);
void gpu_wake_mask(struct gpu *g, int64_t n, const uint16_t *body,
                   const uint8_t *awake, uint8_t *mask);
/* most lies on the host. */
void gpu_wake_displacements(struct gpu *g, int64_t n, const uint16_t *body,
                            const vec *x0, const vec *x1, int bodies,
                            real *most);

#ifdef __cplusplus
}
#endif
#endif
