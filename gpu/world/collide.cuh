/* SPDX-License-Identifier: Apache-2.0 */
/* ref/world/collide.h, and restore of ref/world/slice.h, on the device.
 * spec/world/step.md §3, §7 */
#ifndef GPU_COLLIDE_CUH
#define GPU_COLLIDE_CUH

#include "gpu/base/real.cuh"

void gpu_charge(struct gpu_world *w, drape_step_report *r, enum drape_part part,
                double *last, double within);
real gpu_collide_furthest(struct gpu_world *w, int64_t n);
int gpu_collide_far(struct gpu_world *w, drape_step_report *r, double *last,
                    bool *again);
int gpu_collide(struct gpu_world *w, drape_step_report *r, double *last);

/* gpu/world/restore.cu */
int gpu_slice_save(struct gpu_world *w);
void gpu_slice_restore(struct gpu_world *w);

#endif
