/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a stream of choices; only the harness sees it. */
#ifndef TESTS_CHOICES_H
#define TESTS_CHOICES_H

#include "tests/base/harness.h"

struct bytes {
    uint64_t seed;        /* of the generator, where there is no data */
    const uint32_t *data; /* choices to replay; 0s follow their end */
    size_t n_data, at;
    uint32_t *record; /* every choice made, for the file of a failure */
    size_t n_record, cap_record;
    int64_t size; /* what pick_size gives, -1: from the stream */
    bool bench;
    double last; /* the last real picked, for neighbours and repeats */
    void **taken;
    size_t n_taken, cap_taken;
};

uint32_t choose(struct bytes *b); /* one raw choice */
void choices_free(struct bytes *b);

#endif
