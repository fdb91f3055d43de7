/* SPDX-License-Identifier: Apache-2.0 */
/* Records the trace of a run: the digest of each stage's output. */
#include "tests/base/notes.h"

#include <stdio.h>
#include <stdlib.h>

void notes_take(void *user, int64_t step, const char *stage, uint64_t digest,
                double seconds)
{
    struct notes *a = user;
    (void)step;
    (void)seconds;
    if (a->n == a->room) {
        a->room = 2 * a->room + 64;
        a->note = realloc(a->note, a->room * sizeof *a->note);
        if (!a->note)
            abort();
    }
    struct note *last = &a->note[a->n++];
    snprintf(last->stage, sizeof last->stage, "%s", stage);
    last->digest = digest;
}

const char *notes_compare(const struct notes *a, const struct notes *b)
{
    static char text[96];
    for (size_t k = 0; k < a->n || k < b->n; k++) {
        const char *p = k < a->n ? a->note[k].stage : "nothing";
        const char *q = k < b->n ? b->note[k].stage : "nothing";
        if (!strcmp(p, q) && a->note[k].digest == b->note[k].digest)
            continue;
        snprintf(text, sizeof text, "stage %d: ref ends %s, gpu %s with %s",
                 (int)k, p, q, strcmp(p, q) ? "another stage" : "other bits");
        return text;
    }
    return NULL;
}

void notes_free(struct notes *a)
{
    free(a->note);
    *a = (struct notes){0};
}
