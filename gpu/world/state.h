/* SPDX-License-Identifier: Apache-2.0 */
/* A world on the device: a struct world whose streams are in device memory, and
 * what only the device needs. spec/gpu.md §6 */
#ifndef GPU_STATE_H
#define GPU_STATE_H

#include "ref/world/state.h"

#ifdef __cplusplus
extern "C" {
#endif

struct edited;
struct joint_part;
struct linked;

struct gpu_world {
    struct world world; /* the world that is stepped; its streams and those of
                           its stages are in device memory */
    struct world *host; /* made by ref/world/world.c and never stepped; its
                           streams are used to read, save and load a state */
    struct gpu *gpu;
    vec *star, *b; /* device [nc] each, of implicit motion; b is lagrange's
                      rest, too */
    struct linked *links; /* device [1] the contacts of the joint solve */
    /* Device [nc], [4 lagrange.cap]: the contacts of each vertex that are
     * mutual (gpu/contact/joint.h). */
    int32_t *mutual_end;
    struct mutual *mutual;
    struct joint_part *part; /* host [n_cloths] the cloths in the joint solve */
};

/* Does what world_make_edited says, on the device that is current in this
 * thread. gpu/world/make.cu */
int gpu_make_edited(const drape_def *def, const struct edited *edited,
                    struct arena *arena, struct world **world,
                    drape_error *error);

#ifdef __cplusplus
}
#endif

#endif
