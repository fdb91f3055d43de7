/* SPDX-License-Identifier: Apache-2.0 */
/* Shows how far a run or a film is: one line that is rewritten on a terminal,
 * else a line every few seconds. Lets Ctrl-C end it between steps. */
#ifndef APP_TOOL_PROGRESS_H
#define APP_TOOL_PROGRESS_H

#include <drape.h>
#include <stdbool.h>

struct progress {
    bool terminal;
    int64_t first, total; /* steps at the start of this run, and at its end, or
                             pictures */
    double began, printed;
};

double seconds_now(void); /* of a monotonic clock */
void progress_begin(struct progress *p, int64_t first, int64_t total);
/* Shows the number of steps or pictures that are done, and some words. */
void progress_show(struct progress *p, int64_t done, const char *words);
void progress_step(struct progress *p, const drape_step_report *step);
void progress_end(struct progress *p);

/* From now on the first Ctrl-C only sets what progress_stopped returns, which a
 * command asks between steps; the second one kills the process. */
void progress_catch_stop(void);
bool progress_stopped(void);

#endif
