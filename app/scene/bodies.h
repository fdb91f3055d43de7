/* SPDX-License-Identifier: Apache-2.0 */
/* The readers of a scene's parts; json->user is the struct scene. */
#ifndef APP_SCENE_BODIES_H
#define APP_SCENE_BODIES_H

#include "app/read/json.h"
#include "app/scene/scene.h"
#include "app/scene/shapes.h"

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

/* Bodies that deform: a mesh's frames from files, and limbs that are made in
 * code. */

/* The key `frames` of an obstacle: numbered files of one mesh, or a point cache
 * of the mesh that stands beside it. */
struct sequence {
    char *files;      /* with one %d, as frames/wave_%04d.ply; NULL: none */
    char *file;       /* the point cache; NULL: none */
    int first, count; /* of files; 0: as many as follow each other */
    double dt;
    double *times; /* [n_times] s, ascending; NULL: every dt */
    int n_times;
    int between; /* enum drape_between */
    double lead; /* s in which the mesh beside them goes to the first frame; 0:
                    the first frame is where it begins */
};

/* Reads the key; out: struct sequence. */
json_reader read_sequence;
/* Loads the frames: of numbered files also *mesh, which is the first; of a
 * point cache those of the mesh of the file `name`, which is read, too. With a
 * lead the mesh is that of the file `name`. Sets what `out` has of frames,
 * placed. APP_OK, or the exit code after one line. */
int sequence_load(struct json *json, struct sequence *s, const char *name,
                  const struct placement *placement, struct mesh *mesh,
                  drape_obstacle *out);

/* Finds a mesh file that a scene names, or says that it is not there; whether
 * it is there: obstacle.c. */
int find_mesh(const struct json *json, const char *name, char path[4096]);
bool has_mesh(const struct json *json, const char *name);

/* The keys of a limb: how far it is bent, degrees, at some times, s. */
struct limb {
    struct limb_key {
        double time, angle;
    } * keys; /* [n_keys], times ascend */
    int n_keys;
};

/* Reads the key `bend` of an obstacle; out: struct limb. */
json_reader read_limb;
/* Makes the frames of a mesh, which is that of the straight limb, and sets it
 * to the first one. Sets what `out` has of frames, placed. APP_OK, or the exit
 * code after one line. */
int limb_bend(struct json *json, const struct limb *limb,
              const struct shape *shape, const struct placement *placement,
              struct mesh *mesh, drape_obstacle *out);

#endif
