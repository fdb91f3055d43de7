/* SPDX-License-Identifier: Apache-2.0 */
/* Reads whole files, and writes files that appear complete or not at all. */
#ifndef APP_BASE_FILE_H
#define APP_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FILE_PATH = 4096 };

/* Opens a regular file, or a pipe that a process writes to, for reading; "-" is
 * standard input, which is one of the two. NULL after one line: no other file
 * is opened, and a pipe without a writer is given up after a second. */
FILE *file_stream(const char *path);
/* Returns the file's bytes followed by a zero, or NULL after one line, also if
 * they are a text in UTF-16. The caller frees. */
char *file_read(const char *path, size_t *size);
/* Whether a text begins as one in UTF-16 does: with its mark, or with a
 * character of two bytes of which one is 0. If so, one line is printed. */
bool file_is_utf16(const char *text, size_t size, const char *path);
bool file_exists(const char *path);
bool file_is_directory(const char *path);
bool file_is_regular(const char *path);

/* A file that is being written. It is written in its directory under a name
 * that no other process uses; file_close renames it, so that no reader ever
 * sees an incomplete file under its own name. */
struct file {
    FILE *stream; /* NULL: not open */
    char path[FILE_PATH], part[FILE_PATH];
};
/* Starts writing directory/name. false after one line. */
bool file_open(struct file *file, const char *directory, const char *name);
/* Completes the file and gives it its name. false after one line; then no part
 * of the file is left. */
bool file_close(struct file *file);
/* Deletes the incomplete file. */
void file_drop(struct file *file);

/* Makes the directory and its parents. false after one line, which names the
 * folder that could not be made and says why. */
bool file_make_directory(const char *path);
/* directory/name into path; false after one line if it is too long. */
bool file_join(char path[FILE_PATH], const char *directory, const char *name);

#endif
