/* SPDX-License-Identifier: Apache-2.0 */
/* A run's checkpoint: its settings, the reports of its steps, the library's
 * state, and a checksum of all these bytes. */
#ifndef APP_CHECKPOINT_H
#define APP_CHECKPOINT_H

#include "app/report.h"

/* Writes directory/checkpoint.drape. app_exit after one line. */
int checkpoint_save(const char *directory, const struct report *report,
                    const struct scene *scene, const drape_world *world);

/* A digest of a new world's state and of the definition that belongs to it.
 * DRAPE_OK, or why the library did not give its state. */
int checkpoint_start(const drape_world *world, uint64_t *start);

/* A checkpoint that is read. */
struct checkpoint {
    FILE *stream; /* NULL: not open */
    const char *path;
    struct checkpoint_header {
        char magic[16];
        uint64_t report_bytes; /* of one drape_step_report */
        uint64_t start;        /* checkpoint_start of the run's world */
        int64_t steps;
        double seconds;           /* wall time of the steps */
        struct estimate estimate; /* of --error */
        double dt, tolerance;     /* the scene's, or as --error chose them */
        int32_t steps_per_frame, integrator;
    } header;
};
/* Opens a file and makes sure that every byte of it is as it was written.
 * app_exit after one line. */
int checkpoint_open(struct checkpoint *checkpoint, const char *path);
/* Gives the scene what --error chose, before its world is made. app_exit after
 * one line. */
int checkpoint_settings(const struct checkpoint *checkpoint,
                        struct scene *scene);
/* Brings a new world and its report, which has the world's start, to where the
 * file left them. app_exit after one line. */
int checkpoint_load(struct checkpoint *checkpoint, struct report *report,
                    drape_world *world);
void checkpoint_close(struct checkpoint *checkpoint);

#endif
