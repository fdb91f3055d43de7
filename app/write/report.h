/* SPDX-License-Identifier: Apache-2.0 */
/* report.json: the report of each step of a run, and its totals. */
#ifndef APP_WRITE_REPORT_H
#define APP_WRITE_REPORT_H

#include "app/scene/error.h"
#include "app/write/contacts.h"

struct report {
    drape_step_report *step; /* [count], a diverged step included */
    int64_t count, room;
    double seconds;           /* wall time of the steps */
    struct estimate estimate; /* of --error */
    uint64_t start;           /* a digest of the run's first state */
    struct impulses impulses; /* of --contacts */
};

/* Identifies the frames of a run by the run's start and the steps a frame. Runs
 * with the same identity have the same frames. */
enum { REPORT_ID = 32 };
const char *report_id(const struct report *report, const struct scene *scene,
                      char id[REPORT_ID]);

/* Appends the report of a step. false after one line if memory runs out. */
bool report_add(struct report *report, const drape_step_report *step);
void report_free(struct report *report);

/* The one table of outcomes and their names, in the order of their bits. */
enum { OUTCOMES = 7 };
extern const struct outcome {
    int bit; /* enum drape_outcome */
    const char *name;
} outcomes[OUTCOMES];

/* Outcomes after which a step counts as not clean. */
enum { NOT_CLEAN = DRAPE_TRAPPED | DRAPE_PASSED | DRAPE_DIVERGED };

/* Writes the names of an outcome's bits to text, or "clean" for 0, and returns
 * it. */
const char *report_outcome(int outcome, char text[128]);

/* The counts of work of a step, in the order of drape_work. */
enum { WORKS = 10 };
void report_work(const drape_work *work, int64_t list[WORKS]);

/* Totals of all steps. */
struct totals {
    int64_t steps;             /* tried */
    int64_t done;              /* steps that did not diverge */
    int64_t outcome[OUTCOMES]; /* steps that have this bit */
    int64_t not_clean, unconverged;
    int64_t intersecting;                 /* steps whose end state intersects */
    int64_t first, last;                  /* of these, by their numbers */
    int64_t contacts, rounds, iterations; /* of a step, the most */
    double seconds[DRAPE_PART_COUNT];
    int64_t work[WORKS];
};
void report_sum(const struct report *report, struct totals *totals);

/* Writes directory/report.json. end: how the run ended, in a word. */
bool report_write(const struct report *report, const struct scene *scene,
                  const drape_world *world, const char *directory,
                  const char *end);

#endif
