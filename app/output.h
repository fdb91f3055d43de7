/* SPDX-License-Identifier: Apache-2.0 */
/* What a run leaves in its directory:
 *   frames/cloth_0000.ply .obj   the cloths, frame 0 is the start
 *   obstacles.ply                the obstacles, where none of them moves
 *   frames/obstacles_0000.ply    else, a frame each
 *   cloth.pc2                    all frames, for Blender's Mesh Cache
 *   report.json checkpoint.drape trace.csv */
#ifndef APP_OUTPUT_H
#define APP_OUTPUT_H

#include "app/folder.h"
#include "app/lock.h"
#include "app/scene.h"

struct output {
    char directory[FILE_PATH], frames[FILE_PATH];
    struct mesh all, cloth, obstacles; /* views of the whole scene */
    double (*v)[3]; /* scratch: velocities, which no file holds */
    struct pool pool;
    struct lock lock;
    int bits;
    int every;        /* of the frames, every how many-th is written */
    bool obj, moving; /* moving: some obstacle moves */
};

/* The directory that was given, else one by the scene's name. false after one
 * line where its path is too long. */
bool output_name(char path[FILE_PATH], const struct scene *scene,
                 const char *given);
/* Makes the directories and the views, takes the folder for this run alone,
 * and writes obstacles that do not move. app_exit after one line. */
int output_open(struct output *output, const struct scene *scene,
                const drape_world *world, const char *directory,
                const struct claim *claim);
/* Writes the world's state as frame k, where k is a multiple of every.
 * app_exit after one line. */
int output_frame(struct output *output, const drape_world *world, int k);
/* Writes the point cache of the multiples of every in 0 … last from their PLY
 * files, or a note where one is missing. */
int output_cache(const struct output *output, int last);
void output_close(struct output *output);

/* The numbers, ascending, of the frames of the cloth that a run left in the
 * directory; the caller frees. NULL after one line, also where there are none.
 */
int *output_frames(const char *directory, int *count);
/* directory/frames/<body>_<k>.ply into path. */
bool output_path(char path[FILE_PATH], const char *directory, const char *body,
                 int k);

#endif
