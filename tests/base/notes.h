/* SPDX-License-Identifier: Apache-2.0 */
/* A record of a run's trace: the digest of each stage's output, in order. */
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

/* The callback of type drape_trace that records; user: the struct notes. */
void notes_take(void *user, int64_t step, const char *stage, uint64_t digest,
                double seconds);
/* Describes the first stage at which b, of the device, differs from a, of the
 * reference; NULL if there is none. The text lasts until the next call. */
const char *notes_compare(const struct notes *a, const struct notes *b);
void notes_free(struct notes *a);

#endif
