/* SPDX-License-Identifier: Apache-2.0 */
/* What the stages of a run gave, as its trace tells. */
#include "tests/notes.h"

#include <stdio.h>

void notes_take(void *user, int64_t step, const char *stage, uint64_t digest,
                double seconds)
{
    struct notes *a = user;
    (void)step;
    (void)seconds;
    if (a->n < NOTES) {
        snprintf(a->stage[a->n], sizeof *a->stage, "%s", stage);
        a->digest[a->n] = digest;
    }
    a->n++;
}

const char *notes_compare(const struct notes *a, const struct notes *b)
{
    static char text[64];
    for (int k = 0; k < a->n && k < b->n && k < NOTES; k++)
        if (a->digest[k] != b->digest[k] || strcmp(a->stage[k], b->stage[k])) {
            snprintf(text, sizeof text, "the device's %s differs, as stage %d",
                     a->stage[k], k);
            return text;
        }
    return a->n == b->n ? NULL : "the device traces other stages";
}
