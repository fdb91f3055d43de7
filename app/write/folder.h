/* SPDX-License-Identifier: Apache-2.0 */
/* A run's folder, which holds the files of one run only. */
#ifndef APP_WRITE_FOLDER_H
#define APP_WRITE_FOLDER_H

#include "app/base/file.h"

/* Checks, before a long computation, that the folder holds no files of a run; a
 * missing folder counts as empty. Returns app_exit; a failure prints one line.
 */
int folder_empty(const char *path);

/* The run that is about to write. */
struct claim {
    const char *id;         /* as in its report.json */
    const char *checkpoint; /* that the run resumes from, or NULL */
    int last;               /* last frame before the checkpoint */
    bool force;             /* files of another run may be removed */
};
/* Removes all files that do not belong to this run: those of another run, where
 * this is allowed, and of this run its film, and frames and pictures after the
 * checkpoint. Returns
 * app_exit; a failure prints one line. */
int folder_prepare(const char *path, const struct claim *claim);

/* Removes a film and its pictures: a later film, or a run that goes on, would
 * leave some of them, which would not be its own. Returns app_exit; a failure
 * prints one line. */
int folder_clear_film(const char *path);

/* Returns the numbers, ascending, of the files <body>_<number>.<end> in a
 * folder, with space for one more; the caller frees. A missing folder has none.
 * NULL after one line. */
int *folder_list(const char *path, const char *body, const char *end,
                 int *count);

#endif
