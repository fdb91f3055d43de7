/* SPDX-License-Identifier: Apache-2.0 */
/* Every stage on the device: struct X as for ref_X, with its streams in
 * device memory; struct X itself is the host's, and is ref/'s header's. */
#ifndef GPU_STAGES_H
#define GPU_STAGES_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STAGE(X, rule)                                                         \
    struct X;                                                                  \
    int gpu_##X(struct gpu *g, struct X *s);
#include "spec/stages.def"
#undef STAGE

#ifdef __cplusplus
}
#endif
#endif
