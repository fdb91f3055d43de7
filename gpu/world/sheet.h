/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a cloth of a world on the device. spec/gpu.md §6, §10 */
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

#ifdef __cplusplus
}
#endif
#endif
