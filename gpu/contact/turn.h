/* SPDX-License-Identifier: Apache-2.0 */
/* ref/contact/turn.h on the device. spec/contact/penalty.md §4 */
#ifndef GPU_TURN_H
#define GPU_TURN_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gpu_world;
struct turn;
struct world;

void gpu_turn_begin(struct gpu *g, int64_t n, vec *to, const vec *press,
                    real dt);
void gpu_turn_carry(struct gpu *g, int64_t n, const vec *r, vec *to);
void gpu_turn_load(struct gpu *g, const struct turn *s);
void gpu_turn_move(struct gpu *g, const struct turn *s);
int gpu_turn_make(struct gpu_world *w);
int gpu_turn_room(struct world *w, int64_t n);

#ifdef __cplusplus
}
#endif
#endif
