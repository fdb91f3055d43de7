/* SPDX-License-Identifier: Apache-2.0 */
/* The readers of a scene's parts; json->user is the struct scene. */
#ifndef APP_BODIES_H
#define APP_BODIES_H

#include "app/json.h"
#include "app/scene.h"

/* Bytes that a particle takes in the library at least: what refuses a cloth
 * before anything is allocated for it. */
enum { PARTICLE_BYTES = 512 };

/* out: struct scene, whose def they fill. Motions come first: the others
 * name them. */
json_reader read_motions, read_cloths, read_obstacles;

/* The number of a motion by its name, out: int. */
json_reader read_motion_name;

#endif
