/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of a round of collision response between its stages, on the
 * device: ref/contact/rounds.h. spec/contact/response.md */
#ifndef GPU_ROUNDS_H
#define GPU_ROUNDS_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct contact;
struct response;

void gpu_rounds_start(struct gpu *g, const struct response *s);
void gpu_rounds_advance(struct gpu *g, const struct response *s, int64_t n,
                        const int32_t *vertex, const uint8_t *moved, bool stop);
void gpu_rounds_touch(struct gpu *g, const struct response *s);
void gpu_rounds_settle(struct gpu *g, const struct response *s,
                       struct contact *contact);

#ifdef __cplusplus
}
#endif
#endif
