/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one scene on both backends and compares each stage. */
#ifndef TESTS_TWIN_H
#define TESTS_TWIN_H

#include "tests/base/harness.h"

struct twin {
    int64_t steps; /* compared; 0 where both backends refuse the scene */
    int some, all; /* bitwise or, bitwise and of all steps' outcomes */
};

/* Makes n steps of the scene on the reference and on the device. Returns NULL,
 * or the first difference (a refusal, a stage's digest, a status, a report, a
 * checkpoint). The def's own trace is not called. */
const char *twin_run(const drape_def *def, int n, struct twin *out);

#endif
