/* SPDX-License-Identifier: Apache-2.0 */
/* The contents of a stream of choices, for the harness alone; generators use
 * the functions of harness.h. */
#ifndef TESTS_CHOICES_H
#define TESTS_CHOICES_H

#include "tests/base/harness.h"

struct bytes {
    uint64_t seed;        /* of the random generator, used if data is NULL */
    const uint32_t *data; /* choices to replay, then zeros; or NULL */
    size_t n_data, at;
    uint32_t *record; /* every choice made, to be saved on failure */
    size_t n_record, cap_record;
    int64_t size; /* result of pick_size; -1: chosen from the stream */
    bool bench;
    double last; /* last real chosen, for neighbours and repeats */
    void **taken;
    size_t n_taken, cap_taken;
};

uint32_t choose(struct bytes *b); /* one choice, 32 bits */
void choices_free(struct bytes *b);

#endif
