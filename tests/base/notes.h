/* SPDX-License-Identifier: Apache-2.0 */
/* What the stages of a run gave, as its trace tells. */
#ifndef TESTS_NOTES_H
#define TESTS_NOTES_H

#include "tests/base/harness.h"

struct notes {
    size_t n, room;
    struct note {
        char stage[16];
        uint64_t digest;
    } * note;
};

/* A drape_trace; user is the notes. */
void notes_take(void *user, int64_t step, const char *stage, uint64_t digest,
                double seconds);
/* The first stage of b, the device, that gave something else than a; NULL if
 * none. The text lasts until the next call. */
const char *notes_compare(const struct notes *a, const struct notes *b);
void notes_free(struct notes *a);

#endif
