/* SPDX-License-Identifier: Apache-2.0 */
/* The right to write into a folder: one run has it at a time. */
#ifndef APP_LOCK_H
#define APP_LOCK_H

#include "app/file.h"

/* The kernel takes it back when the process ends, however it ends. */
struct lock {
    char file[FILE_PATH];
    int descriptor; /* of the file */
    bool held;
};
/* Makes the folder and takes the right to write there. app_exit after one
 * line, which names the folder. */
int lock_take(struct lock *lock, const char *path);
void lock_release(struct lock *lock);

/* Whether nobody has it now, without touching the folder. app_exit after one
 * line. */
int lock_look(const char *path);

#endif
