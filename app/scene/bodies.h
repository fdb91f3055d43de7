/* SPDX-License-Identifier: Apache-2.0 */
/* The readers of a scene's parts; json->user is the struct scene. */
#ifndef APP_SCENE_BODIES_H
#define APP_SCENE_BODIES_H

#include "app/read/json.h"
#include "app/scene/scene.h"

/* A lower bound of the library's memory a particle, bytes: a cloth that cannot
 * fit is refused before anything is allocated for it. */
enum { PARTICLE_BYTES = 512 };

/* Fill the def of a struct scene, their `out`. Motions are read first, as
 * cloths and obstacles name them. */
json_reader read_motions, read_cloths, read_obstacles;
/* Adds the panels of garments to the cloths that were read, and their seams. */
json_reader read_garments;

/* Reads a motion's name; out: int, the motion's index. */
json_reader read_motion_name;

#endif
