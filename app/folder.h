/* SPDX-License-Identifier: Apache-2.0 */
/* A run's folder, which holds the files of one run only. */
#ifndef APP_FOLDER_H
#define APP_FOLDER_H

#include "app/file.h"

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
 * this is allowed, and frames of this run after the checkpoint. Returns
 * app_exit; a failure prints one line. */
int folder_prepare(const char *path, const struct claim *claim);

/* Returns the numbers, ascending, of the files <body>_<number>.<end> in a
 * folder, with space for one more; the caller frees. A missing folder has none.
 * NULL after one line. */
int *folder_list(const char *path, const char *body, const char *end,
                 int *count);

#endif
