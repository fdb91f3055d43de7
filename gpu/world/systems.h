/* SPDX-License-Identifier: Apache-2.0 */
/* The systems of a world's cloths, as the joint solve of the device takes them.
 * spec/contact/penalty.md §4 */
#ifndef GPU_SYSTEMS_H
#define GPU_SYSTEMS_H

#ifdef __cplusplus
extern "C" {
#endif

struct gpu_world;
struct joint;
struct world;

/* Takes the list of systems. DRAPE_OK or DRAPE_ENOMEM. */
int gpu_systems_make(struct gpu_world *w);
/* The function `joint` of the backend. */
int gpu_systems_joint(struct world *w, struct joint *s);

#ifdef __cplusplus
}
#endif
#endif
