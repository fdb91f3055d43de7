/* SPDX-License-Identifier: Apache-2.0 */
/* A lock on a folder: one run at a time may write there. */
#ifndef APP_WRITE_LOCK_H
#define APP_WRITE_LOCK_H

#include "app/base/file.h"

/* The kernel releases the lock when the process ends, however it ends. */
struct lock {
    char file[FILE_PATH];
    int descriptor; /* of the file */
    bool held;
};
/* Makes the folder and locks it. Returns app_exit; a failure prints one line
 * that names the folder. */
int lock_take(struct lock *lock, const char *path);
void lock_release(struct lock *lock);

/* Checks that no process holds the lock, without changing the folder. Returns
 * app_exit; a failure prints one line. */
int lock_is_free(const char *path);

#endif
