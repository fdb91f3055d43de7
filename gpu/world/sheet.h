/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a cloth of a world on the device. spec/gpu.md §6, §10 */
#ifndef GPU_WORLD_SHEET_H
#define GPU_WORLD_SHEET_H

#include "gpu/cloth/sheet.h"
#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes s, whose `device` is set, a copy of the host's sheet h with its streams
 * on the device. posed: the poses of the world's motions, there; star, b:
 * streams of all cloths, of implicit motion. A lack of memory shows in
 * gpu_status. */
void gpu_sheet_make(struct gpu *g, const struct sheet *h,
                    const struct pose *posed, vec *star, vec *b,
                    struct sheet *s);

#ifdef __cplusplus
}
#endif
#endif
