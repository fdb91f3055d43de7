/* SPDX-License-Identifier: Apache-2.0 */
/* What the stages of a run gave, as its trace tells. */
#ifndef TESTS_NOTES_H
#define TESTS_NOTES_H

#include "tests/harness.h"

enum { NOTES = 8192 };

struct notes {
    int n; /* those beyond NOTES are counted only */
    char stage[NOTES][16];
    uint64_t digest[NOTES];
};

/* A drape_trace; user is the notes. */
void notes_take(void *user, int64_t step, const char *stage, uint64_t digest,
                double seconds);
/* The first stage of b, the device, that gave something else than a; NULL if
 * none. */
const char *notes_compare(const struct notes *a, const struct notes *b);

#endif
