/* SPDX-License-Identifier: Apache-2.0 */
/* The systems of a world's cloths, as the joint solve of the device takes them,
 * and the memory of the motion with contacts. spec/contact/lagrange.md §3.2 */
#ifndef GPU_SYSTEMS_H
#define GPU_SYSTEMS_H

#ifdef __cplusplus
extern "C" {
#endif

struct gpu_world;

/* Takes the list of systems. DRAPE_OK or DRAPE_ENOMEM. */
int gpu_systems_make(struct gpu_world *w);
/* unknowns_make of ref/contact/unknowns.h on the device. */
int gpu_systems_streams(struct gpu_world *w);

#ifdef __cplusplus
}
#endif
#endif
