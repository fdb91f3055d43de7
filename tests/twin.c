/* SPDX-License-Identifier: Apache-2.0 */
/* One scene on both backends, as tests/twin.h says. */
#include "tests/twin.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/scene.h"

/* What a step's stages gave, in order. */
struct log {
    size_t n, cap;
    struct entry {
        const char *stage;
        uint64_t digest;
    } * entry;
};

static void note(void *user, int64_t step, const char *stage, uint64_t digest,
                 double seconds)
{
    struct log *log = user;
    (void)step;
    (void)seconds;
    if (log->n == log->cap) {
        log->cap = 2 * log->cap + 64;
        log->entry = realloc(log->entry, log->cap * sizeof *log->entry);
        if (!log->entry)
            abort();
    }
    log->entry[log->n++] = (struct entry){stage, digest};
}

static char text[160];

static const char *compare_logs(int step, const struct log *a,
                                const struct log *b)
{
    for (size_t k = 0; k < a->n || k < b->n; k++) {
        const char *p = k < a->n ? a->entry[k].stage : "nothing";
        const char *q = k < b->n ? b->entry[k].stage : "nothing";
        if (!strcmp(p, q) && a->entry[k].digest == b->entry[k].digest)
            continue;
        snprintf(text, sizeof text,
                 "step %d, stage %d: ref ends %s, gpu %s with %s", step, (int)k,
                 p, q, strcmp(p, q) ? "another stage" : "other bits");
        return text;
    }
    return NULL;
}

static const char *compare_reports(int step, drape_step_report a,
                                   drape_step_report b)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    const unsigned char *p = (const void *)&a, *q = (const void *)&b;
    for (size_t k = 0; k < sizeof a; k++)
        if (p[k] != q[k]) {
            snprintf(text, sizeof text,
                     "step %d: the reports differ at byte %d", step, (int)k);
            return text;
        }
    return NULL;
}

static const char *step_both(drape_world *world[2], struct log log[2], int step)
{
    drape_step_report r[2];
    int status[2];
    memset(r, 0, sizeof r);
    for (int k = 0; k < 2; k++) {
        log[k].n = 0;
        status[k] = drape_step(world[k], &r[k]);
    }
    const char *failed = compare_logs(step, &log[0], &log[1]);
    if (!failed && status[0] != status[1]) {
        snprintf(text, sizeof text, "step %d: status %d and %d", step,
                 status[0], status[1]);
        failed = text;
    }
    return failed ? failed : compare_reports(step, r[0], r[1]);
}

const char *twin_run(const drape_def *def, int n, int64_t *steps)
{
    drape_world *world[2];
    drape_error error[2];
    struct log log[2] = {{0}, {0}};
    int status[2];
    const char *failed = NULL;
    for (int k = 0; k < 2; k++) {
        drape_def d = *def;
        d.backend = k ? DRAPE_GPU : DRAPE_REF;
        d.trace = note;
        d.trace_user = &log[k];
        status[k] = drape_create(&d, &world[k], &error[k]);
    }
    if (status[0] != status[1] || strcmp(error[0].text, error[1].text)) {
        snprintf(text, sizeof text, "created with %d and %d: %.100s", status[0],
                 status[1], error[1].text);
        failed = text;
    }
    for (int k = 0; k < n && world[0] && world[1] && !failed; k++) {
        failed = step_both(world, log, k);
        *steps += 1;
    }
    if (!failed && world[0] && scene_hash(world[0]) != scene_hash(world[1]))
        failed = "the states at the end differ";
    for (int k = 0; k < 2; k++) {
        drape_destroy(world[k]);
        free(log[k].entry);
    }
    return failed;
}
