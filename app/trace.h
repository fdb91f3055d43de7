/* SPDX-License-Identifier: Apache-2.0 */
/* trace.csv: a digest of each stage of each step of a run. */
#ifndef APP_TRACE_H
#define APP_TRACE_H

#include "app/file.h"

#include <stdint.h>

/* Begins directory/trace.csv anew with the rows of the steps before `done`
 * that are there already, from before a checkpoint. app_exit after one line. */
int trace_begin(struct file *trace, const char *directory, int64_t done);
/* drape_trace: user is the file. */
void trace_row(void *user, int64_t step, const char *stage, uint64_t digest,
               double seconds);
/* Whether all rows so far went through. app_exit after one line. */
int trace_check(struct file *trace);
/* Makes the rows so far directory/trace.csv, and goes on: a run that is killed
 * later leaves them beside its checkpoint. app_exit after one line. */
int trace_publish(struct file *trace, const char *directory);

#endif
