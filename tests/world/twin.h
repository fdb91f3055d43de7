/* SPDX-License-Identifier: Apache-2.0 */
/* One scene on both backends, stage by stage. */
#ifndef TESTS_TWIN_H
#define TESTS_TWIN_H

#include "tests/base/harness.h"

struct twin {
    int64_t steps; /* compared; 0 where both refuse the scene alike */
    int some, all; /* outcomes: or of all steps', and of all steps' */
};

/* Steps the scene on the reference and on the device: NULL, or what differs
 * first (a refusal, a stage's digest, a status, a report, a checkpoint). The
 * def's trace is not called. */
const char *twin_run(const drape_def *def, int n, struct twin *out);

#endif
