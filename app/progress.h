/* SPDX-License-Identifier: Apache-2.0 */
/* Shows how far a run is: one line that is rewritten on a terminal, else a line
 * every few seconds. */
#ifndef APP_PROGRESS_H
#define APP_PROGRESS_H

#include <drape.h>
#include <stdbool.h>

struct progress {
    bool terminal;
    int64_t first, total; /* steps at the start of this run, and at its end */
    double began, printed;
};

double seconds_now(void); /* of a monotonic clock */
void progress_begin(struct progress *p, int64_t first, int64_t total);
void progress_step(struct progress *p, const drape_step_report *step);
void progress_end(struct progress *p);

#endif
