/* SPDX-License-Identifier: Apache-2.0 */
/* A world on the device: a struct world whose streams are in device memory, and
 * what only the device needs. spec/gpu.md §6 */
#ifndef GPU_WORLD_H
#define GPU_WORLD_H

#include "gpu/cloth/rate.h"
#include "ref/contact/turn.h"
#include "ref/world/led.h"
#include "ref/world/state.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the device needs for a cloth in addition to its struct sheet. */
struct gpu_sheet {
    struct law *law;     /* device [SPRINGS] */
    struct piece *piece; /* device [PIECES] */
    real *triple;        /* device [TRIPLES] */
    struct rate *rate;   /* device; NULL: the solve does not use rates */
    vec *star, *b;       /* device [count], parts of the world's star and b */
};

struct gpu_world {
    struct world
        world;          /* the world that is stepped; its streams and those of
                           its stages are in device memory; broad.arena is NULL */
    struct world *host; /* made by ref/world/world.c and never stepped; its
                           streams are used to read, save and load a state */
    struct gpu *gpu;
    vec *star, *b; /* device [nc] each, of implicit motion. When contact begins,
                      star is couple's g, and b, which is [nv] if anything can
                      collide, is couple's force */
    struct links *links; /* device [1] the contacts of the joint solve */
};

/* gpu/world/backend.cu */
extern const struct backend backend_gpu;

/* gpu/world/led.cu: ref/world/led.h on the device. */
void gpu_led_pin(struct gpu *g, int64_t n, const int32_t *pinned, const vec *x,
                 vec *to);
bool gpu_led_moves(const struct world *w);
void gpu_led_blend(struct gpu *g, const struct blend *s);
void gpu_led_keep(struct gpu *g, int64_t n, const uint8_t *fixed,
                  const vec *old, vec *a);
bool gpu_led_sane(struct gpu *g, int64_t n, const vec *a);
void gpu_led_velocities(struct gpu *g, int64_t n, const vec *x0, const vec *x1,
                        real dt, vec *v);
real gpu_led_furthest(struct gpu *g, int64_t n, const vec *x0, const vec *x1);
/* group [nt]: 1 for the first `cloths` triangles, else 0. */
void gpu_led_group(struct gpu *g, int64_t nt, int64_t cloths, int32_t *group);

/* gpu/cloth/motion.cu: ref_dynamics and dynamics_energy on the device. */
int gpu_motion(struct gpu *g, struct sheet *s);
void gpu_motion_energy(struct gpu *g, struct sheet *s, const vec *x,
                       const vec *v, double value[3]);

/* gpu/contact/rounds.cu: ref/contact/rounds.c on the device. */
void gpu_rounds_start(struct gpu *g, const struct response *s);
void gpu_rounds_advance(struct gpu *g, const struct response *s, int64_t n,
                        const int32_t *vertex, const uint8_t *moved, bool stop);
void gpu_rounds_touch(struct gpu *g, const struct response *s);
void gpu_rounds_settle(struct gpu *g, const struct response *s,
                       struct contact *contact);

/* gpu/contact/turn.cu: ref/contact/turn.h on the device. */
void gpu_turn_begin(struct gpu *g, int64_t n, vec *to, const vec *press,
                    real dt);
void gpu_turn_carry(struct gpu *g, int64_t n, const vec *r, vec *to);
void gpu_turn_load(struct gpu *g, const struct turn *s);
void gpu_turn_move(struct gpu *g, const struct turn *s);
int gpu_turn_make(struct gpu_world *w);
int gpu_turn_room(struct world *w, int64_t n);

/* gpu/solve/joint.cu: ref/solve/joint.h on the device. */
int gpu_joint(struct world *w, struct joint *s);

#ifdef __cplusplus
}
#endif
#endif
