/* SPDX-License-Identifier: Apache-2.0 */
/* Prescribed places on the device: the streams of stage kinematics.
 * spec/world/kinematics.md */
#ifndef GPU_KINEMATICS_H
#define GPU_KINEMATICS_H

#include "gpu/run/gpu.h"
#include "ref/world/kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Copies a stage of the host to k, whose streams are taken on the device, but
 * for x. posed: the poses, on the device. */
void gpu_kinematics_make(struct gpu *g, enum arena_part part,
                         const struct kinematics *host,
                         const struct pose *posed, struct kinematics *k);

#ifdef __cplusplus
}
#endif
#endif
