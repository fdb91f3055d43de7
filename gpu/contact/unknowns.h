/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of ref/contact/unknowns.h on the device.
 * spec/contact/lagrange.md */
#ifndef GPU_UNKNOWNS_H
#define GPU_UNKNOWNS_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jumps;
struct shift;

void gpu_unknowns_shift(struct gpu *g, const struct shift *s);
void gpu_unknowns_jump(struct gpu *g, const struct jumps *s);
void gpu_unknowns_lessen(struct gpu *g, int64_t n, real part, const vec *q,
                         vec *r);

#ifdef __cplusplus
}
#endif
#endif
