/* SPDX-License-Identifier: Apache-2.0 */
/* How far a run is: one moving line on a terminal, else plain lines. */
#ifndef APP_PROGRESS_H
#define APP_PROGRESS_H

#include <drape.h>
#include <stdbool.h>

struct progress {
    bool terminal;
    int64_t first, total; /* steps before this call, and at its end */
    double began, printed;
};

double seconds_now(void); /* of a clock that only goes forward */
void progress_begin(struct progress *p, int64_t first, int64_t total);
void progress_step(struct progress *p, const drape_step_report *step);
void progress_end(struct progress *p);

#endif
