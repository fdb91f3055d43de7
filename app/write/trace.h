/* SPDX-License-Identifier: Apache-2.0 */
/* trace.csv: a digest of each stage of each step of a run. */
#ifndef APP_WRITE_TRACE_H
#define APP_WRITE_TRACE_H

#include "app/base/file.h"

#include <stdint.h>

/* Begins a new directory/trace.csv with the existing rows of the steps before
 * `done`, the step of a checkpoint. Returns app_exit; a failure prints one
 * line.
 */
int trace_begin(struct file *trace, const char *directory, int64_t done);
/* A drape_trace that writes a row; user is the file. */
void trace_row(void *user, int64_t step, const char *stage, uint64_t digest,
               double seconds);
/* Checks that all rows so far were written. Returns app_exit; a failure prints
 * one line. */
int trace_check(struct file *trace);
/* Publishes the rows so far as directory/trace.csv and continues, so that a run
 * that is killed later leaves them beside its checkpoint. Returns app_exit; a
 * failure prints one line. */
int trace_publish(struct file *trace, const char *directory);

#endif
