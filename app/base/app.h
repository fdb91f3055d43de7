/* SPDX-License-Identifier: Apache-2.0 */
/* Exit codes and messages, shared by all of the tool. */
#ifndef APP_BASE_APP_H
#define APP_BASE_APP_H

#include <stdbool.h>

enum app_exit {
    APP_OK = 0,
    APP_FINDINGS = 1, /* audit found pairs, or a step is not clean */
    APP_USAGE = 2,    /* a wrong command line or bad input */
    APP_FAILED = 3,   /* disk, memory or device at run time */
    APP_INTERRUPTED = 130
};

/* Set by --quiet: errors alone are printed. */
extern bool app_quiet;

/* Prints "drape: …" as one line on standard error and returns code. A line of
 * code 0 is a note, which --quiet suppresses. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int complain(int code, const char *format, ...);
/* Complains that there is no memory; APP_FAILED. */
int no_memory(void);

/* Prints to standard output what a command did, unless --quiet was given. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void say(const char *format, ...);

#endif
