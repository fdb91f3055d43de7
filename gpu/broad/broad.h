/* SPDX-License-Identifier: Apache-2.0 */
/* The broad phase of a world on the device: copies the result of
 * broad_make from the host. spec/broad/broad.md */
#ifndef GPU_BROAD_H
#define GPU_BROAD_H

#ifdef __cplusplus
extern "C" {
#endif

#include "gpu/run/gpu.h"
#include "ref/broad/broad.h"

int gpu_broad_make(struct gpu *g, const struct broad *host, struct broad *b);

#ifdef __cplusplus
}
#endif
#endif
