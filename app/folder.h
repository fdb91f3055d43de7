/* SPDX-License-Identifier: Apache-2.0 */
/* What a run's folder holds: the files of one run. */
#ifndef APP_FOLDER_H
#define APP_FOLDER_H

#include "app/file.h"

/* Whether no run has left anything there, asked before a long computation; a
 * folder that is not there is empty. app_exit after one line. */
int folder_empty(const char *path);

/* The run that is about to write. */
struct claim {
    const char *id;         /* as in its report.json */
    const char *checkpoint; /* that it goes on from, or NULL */
    int last;               /* frame that the checkpoint has behind it */
    bool force;             /* what another run has left may go */
};
/* Leaves in the folder nothing but what belongs to this run: all of another
 * run goes where that is allowed, and of this run what it has not come to yet.
 * app_exit after one line. */
int folder_prepare(const char *path, const struct claim *claim);

/* The numbers, ascending, of the files <body>_<number>.<end> in a folder; the
 * caller frees. There is room for one more behind them. NULL after one line;
 * none where there is no such folder. */
int *folder_list(const char *path, const char *body, const char *end,
                 int *count);

#endif
