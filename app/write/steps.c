/* SPDX-License-Identifier: Apache-2.0 */
/* The reports of a run's steps, and their totals. */
#include "app/base/app.h"
#include "app/write/report.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

const struct outcome outcomes[OUTCOMES] = {{DRAPE_UNCONVERGED, "unconverged"},
                                           {DRAPE_ZONES, "zones"},
                                           {DRAPE_ROLLBACK, "rollback"},
                                           {DRAPE_TRAPPED, "trapped"},
                                           {DRAPE_DIVERGED, "diverged"},
                                           {DRAPE_ASLEEP, "asleep"},
                                           {DRAPE_PASSED, "passed"}};
/* DRAPE_PASSED is the last bit: every bit below it has its row. */
_Static_assert(1 << (OUTCOMES - 1) == DRAPE_PASSED, "an outcome has no name");

bool report_add(struct report *report, const drape_step_report *step)
{
    if (report->count == report->room) {
        int64_t room = report->room ? 2 * report->room : 256;
        drape_step_report *larger =
            realloc(report->step, (size_t)room * sizeof *larger);
        if (!larger) {
            complain(APP_FAILED, "out of memory");
            return false;
        }
        report->step = larger;
        report->room = room;
    }
    report->step[report->count++] = *step;
    return true;
}

const char *report_id(const struct report *report, const struct scene *scene,
                      char id[REPORT_ID])
{
    snprintf(id, REPORT_ID, "%016" PRIx64 "-%d", report->start,
             scene->steps_per_frame);
    return id;
}

void report_free(struct report *report)
{
    contacts_free(&report->impulses);
    free(report->step);
}

const char *report_outcome(int outcome, char text[128])
{
    strcpy(text, outcome ? "" : "clean");
    for (int k = 0; k < OUTCOMES; k++)
        if (outcome & outcomes[k].bit) {
            strcat(text, *text ? "+" : "");
            strcat(text, outcomes[k].name);
        }
    return text;
}

void report_work(const drape_work *w, int64_t list[WORKS])
{
    const int64_t all[WORKS] = {w->tries, w->solves,     w->queries, w->narrow,
                                w->boxes, w->boxes_kept, w->walked,  w->cleared,
                                w->near,  w->later};
    memcpy(list, all, sizeof all);
}

static void count_outcome(struct totals *t, const drape_step_report *s)
{
    for (int j = 0; j < OUTCOMES; j++)
        t->outcome[j] += (s->outcome & outcomes[j].bit) != 0;
    t->done += !(s->outcome & DRAPE_DIVERGED);
    t->not_clean += (s->outcome & NOT_CLEAN) != 0;
    t->unconverged += (s->outcome & DRAPE_UNCONVERGED) != 0;
    if (!(s->outcome & DRAPE_TRAPPED))
        return;
    if (t->intersecting++ == 0)
        t->first = s->step;
    t->last = s->step;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

void report_sum(const struct report *report, struct totals *t)
{
    *t = (struct totals){.steps = report->count};
    for (int64_t k = 0; k < report->count; k++) {
        const drape_step_report *s = &report->step[k];
        int64_t work[WORKS];
        count_outcome(t, s);
        for (int j = 0; j < DRAPE_PART_COUNT; j++)
            t->seconds[j] += s->seconds[j];
        report_work(&s->work, work);
        for (int j = 0; j < WORKS; j++)
            t->work[j] += work[j];
        t->contacts = larger(t->contacts, s->contacts);
        t->rounds = larger(t->rounds, s->rounds);
        t->iterations = larger(t->iterations, s->iterations);
    }
}
