/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a cloth and prescribed places of a world on the device. spec/gpu.md §6,
 * §10 */
#ifndef GPU_WORLD_SHEET_H
#define GPU_WORLD_SHEET_H

#include "gpu/cloth/sheet.h"
#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gpu_world;

/* Makes cloth k of the world that is stepped, whose `device` is set, a copy of
 * the host's with its streams on the device. posed, star and b of the world are
 * there. A lack of memory shows in gpu_status. */
void gpu_sheet_make(struct gpu_world *d, int k);

/* Copies a stage of the host to k, whose streams are taken on the device, but
 * for x. posed: the poses, on the device. */
void gpu_kinematics_make(struct gpu *g, enum arena_part part,
                         const struct kinematics *host,
                         const struct pose *posed, struct kinematics *k);

#ifdef __cplusplus
}
#endif
#endif
