/* SPDX-License-Identifier: Apache-2.0 */
/* What the running test has counted; check resets the counts before each
 * test. */
#ifndef TESTS_TALLY_H
#define TESTS_TALLY_H

#include "tests/base/harness.h"

struct tally {
    int64_t cases;
    const char *skipped; /* why, or NULL */
};
extern struct tally tally;

#endif
