/* SPDX-License-Identifier: Apache-2.0 */
/* Writes how garments were sewn: sew.json, and the sewn garments as meshes. */
#ifndef APP_WRITE_SEWN_H
#define APP_WRITE_SEWN_H

#include "app/scene/sewing.h"

/* A frame of sewing: its audit, and its seams. */
struct sewn_frame {
    int frame;
    int64_t step;
    enum sewing_stage stage;
    double gap;          /* the largest of the seams whose turn has come, as a
                            part of a cell */
    int seam;            /* that has it; -1: none has begun */
    int waiting;         /* points that pull as hard as they may */
    int open;            /* seams of these */
    int64_t pairs, sewn; /* intersecting: that can collide; sewn together */
};
struct sewn {
    struct sewn_frame *frame; /* [count] */
    int count, room;
};

/* Appends the present frame. Returns app_exit. */
int sewn_add(struct sewn *sewn, struct sewing *sewing, int frame);
void sewn_free(struct sewn *sewn);
/* Writes directory/sew.json. false after one line. */
bool sewn_write(const struct sewn *sewn, const struct sewing *sewing,
                const char *directory);
/* Writes each garment as directory/sewn_NUMBER.ply: all its particles where
 * they are. false after one line. */
bool sewn_save(struct sewing *sewing, const char *directory);

/* Names the files of a scene wholly, as what is written of it is in another
 * folder than its `file`. */
void sewn_name_files(json_t *root, const char *file);
/* Writes the scene that begins where the meshes sewn_NUMBER.ply have its
 * garments. false after one line. */
bool sewn_put_scene(json_t *root, const char *directory, const char *name);

#endif
