/* SPDX-License-Identifier: Apache-2.0 */
/* A run's folder: one run writes there at a time, and what it holds is of one
 * run only. */
#ifndef APP_FOLDER_H
#define APP_FOLDER_H

#include "app/file.h"

/* The right to write into a folder. The kernel takes it back when the process
 * ends, however it ends. */
struct folder {
    char path[FILE_PATH], lock[FILE_PATH];
    int descriptor; /* of the lock */
    bool held;
};
/* Makes the folder and takes the right to write there. app_exit after one
 * line, which names the folder. */
int folder_take(struct folder *folder, const char *path);
void folder_release(struct folder *folder);

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
int folder_prepare(const struct folder *folder, const struct claim *claim);

/* The numbers, ascending, of the files <body>_<number>.<end> in a folder; the
 * caller frees. There is room for one more behind them. NULL after one line;
 * none where there is no such folder. */
int *folder_list(const char *path, const char *body, const char *end,
                 int *count);

#endif
