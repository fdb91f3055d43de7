/* SPDX-License-Identifier: Apache-2.0 */
/* Declares every stage X on the device: gpu_X takes the struct X of ref_X,
 * whose streams are in device memory. The struct itself is in host memory. */
#ifndef GPU_STAGES_H
#define GPU_STAGES_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STAGE(room, file, X, rule)                                             \
    struct X;                                                                  \
    int gpu_##X(struct gpu *g, struct X *s);
#include "spec/stages.def"
#undef STAGE

#ifdef __cplusplus
}
#endif
#endif
