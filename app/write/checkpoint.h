/* SPDX-License-Identifier: Apache-2.0 */
/* A run's checkpoint: its settings, the reports of its steps, the library's
 * state, and a checksum of all these bytes. */
#ifndef APP_WRITE_CHECKPOINT_H
#define APP_WRITE_CHECKPOINT_H

#include "app/write/report.h"

/* Writes directory/checkpoint.drape. Returns app_exit; a failure prints one
 * line.
 */
int checkpoint_save(const char *directory, const struct report *report,
                    const struct scene *scene, const drape_world *world);

/* *start: a digest of a new world's state and definition. DRAPE_OK, or the
 * status with which the library refused to save. */
int checkpoint_start(const drape_world *world, uint64_t *start);

/* A checkpoint that is being read. */
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
/* Opens a file and verifies its checksum. Returns app_exit; a failure prints
 * one line. */
int checkpoint_open(struct checkpoint *checkpoint, const char *path);
/* Gives the scene the settings that --error chose, before its world is made.
 * Returns app_exit; a failure prints one line. */
int checkpoint_settings(const struct checkpoint *checkpoint,
                        struct scene *scene);
/* Loads the state and the reports of the file into a new world and its report,
 * which must have the same start. Returns app_exit; a failure prints one line.
 */
int checkpoint_load(struct checkpoint *checkpoint, struct report *report,
                    drape_world *world);
void checkpoint_close(struct checkpoint *checkpoint);

#endif
