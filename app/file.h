/* SPDX-License-Identifier: Apache-2.0 */
/* Files read whole, and files that appear whole or not at all. */
#ifndef APP_FILE_H
#define APP_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FILE_PATH = 4096 };

/* The file's bytes with a zero behind them, or NULL after one line. The
 * caller frees. */
char *file_read(const char *path, size_t *size);
bool file_exists(const char *path);
bool file_is_directory(const char *path);

/* A file under way: it is written beside its place, under a name that no other
 * process takes, and renamed into its place by file_close, so that its own name
 * never shows a part of it. */
struct file {
    FILE *stream; /* NULL: not open */
    char path[FILE_PATH], part[FILE_PATH];
};
/* false after one line. */
bool file_open(struct file *file, const char *directory, const char *name);
/* false after one line; nothing is left of the file then. */
bool file_close(struct file *file);
/* Drops what was written. */
void file_drop(struct file *file);

/* Makes the directory and its parents. false after one line, which names the
 * folder that could not be made and says why. */
bool file_make_directory(const char *path);
/* directory/name into path; false after one line if it is too long. */
bool file_join(char path[FILE_PATH], const char *directory, const char *name);

#endif
