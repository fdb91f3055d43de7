/* SPDX-License-Identifier: Apache-2.0 */
/* The broad phase of a world on the device: copies the result of broad_make
 * from the host, and runs broad_meshes_apart and broad_query.
 * spec/broad/broad.md */
#ifndef GPU_BROAD_H
#define GPU_BROAD_H

#ifdef __cplusplus
extern "C" {
#endif

#include "gpu/run/gpu.h"
#include "ref/broad/broad.h"

int gpu_broad_make(struct gpu *g, const struct broad *host, struct broad *b);
int gpu_broad_meshes_apart(struct gpu *g, struct broad *b, const vec *x0,
                           const vec *x1, real r, bool *apart);
int gpu_broad_query(struct gpu *g, struct broad *b, const vec *x0,
                    const vec *x1, real r, const uint8_t *moved);

#ifdef __cplusplus
}
#endif
#endif
