/* SPDX-License-Identifier: Apache-2.0 */
/* Writes the files of a run into its directory:
 *   frames/cloth_0000.ply        the cloths, frame 0 is the start
 *   obstacles.ply                the obstacles, where none of them moves
 *   frames/obstacles_0000.ply    else, a frame each
 *   frames/contacts_0000.ply     what touched in the frame's last step, where
 *                                asked for
 *   .obj                         with each of these, where asked for
 *   rest.ply                     the cloths at rest, where there are panels
 *   cloth.pc2                    all frames, for Blender's Mesh Cache
 *   report.json checkpoint.drape trace.csv parted.json seams.json */
#ifndef APP_WRITE_OUTPUT_H
#define APP_WRITE_OUTPUT_H

#include "app/scene/scene.h"
#include "app/write/folder.h"
#include "app/write/lock.h"
#include "app/write/stretch.h"

struct output {
    char directory[FILE_PATH], frames[FILE_PATH];
    struct mesh all, cloth, obstacles; /* views of the whole scene */
    struct part *cloth_part, *obstacle_part;
    int cloths, n_obstacles; /* number of their parts */
    const drape_cloth *made; /* [cloths] of the scene */
    struct stretch *stretch; /* [cloths] of the frames that were written */
    double (*v)[3];          /* scratch: velocities, which no file has */
    struct pool pool;
    struct lock lock;
    int bits;
    int every;        /* of the frames, every how many-th is written */
    bool obj, moving; /* moving: some obstacle moves */
    bool contacts;    /* they are asked for */
};

/* Puts the given directory into path, or one named after the scene. false after
 * one line if the path is too long. */
bool output_name(char path[FILE_PATH], const struct scene *scene,
                 const char *given);
/* Makes the directories and the views, claims the folder for this run, and
 * writes the obstacles if none moves. Returns app_exit; a failure prints one
 * line. */
int output_open(struct output *output, const struct scene *scene,
                const drape_world *world, const char *directory,
                const struct claim *claim);
/* Writes the world's state as frame k, if k is a multiple of `every`. Returns
 * app_exit; a failure prints one line. */
int output_frame(struct output *output, drape_world *world, int k);
/* Writes the point cache of the frames 0 … last that are multiples of `every`,
 * from their PLY files; prints a note if a file is missing. */
int output_cache(const struct output *output, int last);
void output_close(struct output *output);

/* Returns the numbers, ascending, of the cloth's frames in a run's directory;
 * the caller frees. NULL after one line, also if there are no frames. */
int *output_frames(const char *directory, int *count);
/* Puts directory/frames/<body>_<k>.ply into path. false if it is too long. */
bool output_path(char path[FILE_PATH], const char *directory, const char *body,
                 int k);

#endif
