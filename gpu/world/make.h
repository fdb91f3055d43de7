/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a world on the device. spec/gpu.md §6 */
#ifndef GPU_MAKE_H
#define GPU_MAKE_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct edited;
struct world;

/* Does what world_make_edited says, on the device that is current in this
 * thread. */
int gpu_make_edited(const drape_def *def, const struct edited *edited,
                    struct arena *arena, struct world **world,
                    drape_error *error);

#ifdef __cplusplus
}
#endif
#endif
