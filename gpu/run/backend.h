/* SPDX-License-Identifier: Apache-2.0 */
/* The table of the device's functions, and those of them that are no stage.
 * ref/base/backend.h, ref/base/backend.def */
#ifndef GPU_BACKEND_H
#define GPU_BACKEND_H

#include "gpu/run/gpu.h"
#include "ref/base/backend.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CALL(result, name, ...) result gpu_##name(__VA_ARGS__);
#include "ref/base/backend.def"
#undef CALL

extern const struct backend backend_gpu; /* gpu/world/backend.cu */

#ifdef __cplusplus
}
#endif
#endif
