/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a world on the device. spec/gpu.md §6 */
#ifndef GPU_MAKE_H
#define GPU_MAKE_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct heir;
struct world;

/* Does what world_make_heir says, on the device that is current in this
 * thread. */
int gpu_make_heir(const drape_def *def, const struct heir *heir,
                  struct arena *arena, struct world **world,
                  drape_error *error);

#ifdef __cplusplus
}
#endif
#endif
