/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that deform: a mesh's frames from files, and when each of them is. */
#ifndef APP_SCENE_SEQUENCE_H
#define APP_SCENE_SEQUENCE_H

#include "app/read/json.h"
#include "app/read/mesh.h"
#include "spec/drape.h"

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

#endif
