/* SPDX-License-Identifier: Apache-2.0 */
/* The systems of a world's cloths, as the joint solve of the device takes them,
 * and the memory of the motion with contacts. spec/contact/lagrange.md §3.2 */
#ifndef GPU_SYSTEMS_H
#define GPU_SYSTEMS_H

#ifdef __cplusplus
extern "C" {
#endif

#include "ref/base/real.h"

struct gpu_world;
struct joint;
struct world;

/* Takes the list of systems. DRAPE_OK or DRAPE_ENOMEM. */
int gpu_systems_make(struct gpu_world *w);
/* unknowns_make and unknowns_room of ref/contact/unknowns.h on the device. */
int gpu_systems_streams(struct gpu_world *w);
int gpu_systems_room(struct world *w, int64_t n);
/* The functions of the backend: joint_set_up, joint_measure and joint. */
int gpu_systems_set_up(struct world *w, struct joint *s);
int gpu_systems_measure(struct world *w, struct joint *s, const vec *r,
                        real *value);
int gpu_systems_joint(struct world *w, struct joint *s);

#ifdef __cplusplus
}
#endif
#endif
