/* SPDX-License-Identifier: Apache-2.0 */
/* report.json: every step of a run, and what it came to. */
#ifndef APP_REPORT_H
#define APP_REPORT_H

#include "app/error.h"

struct report {
    drape_step_report *step; /* [count] */
    int64_t count, room;
    double seconds;           /* wall time of the steps */
    struct estimate estimate; /* of --error */
};

/* false after one line when memory is out. */
bool report_add(struct report *report, const drape_step_report *step);
void report_free(struct report *report);

/* Outcomes after which a step's state is not what was asked for. */
enum { NOT_CLEAN = DRAPE_TRAPPED | DRAPE_DIVERGED };

/* The outcome as words, "clean" for 0; the text lasts until the next call
 * with the same buffer. */
const char *report_outcome(int outcome, char text[128]);

/* Writes directory/report.json. end: how the run ended, in a word. */
bool report_write(const struct report *report, const struct scene *scene,
                  const drape_world *world, const char *directory,
                  const char *end);

#endif
