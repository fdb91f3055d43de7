/* SPDX-License-Identifier: Apache-2.0 */
/* One scene on both backends, stage by stage. */
#ifndef TESTS_TWIN_H
#define TESTS_TWIN_H

#include "tests/harness.h"

/* Steps the scene on the reference and on the device: NULL, or what differs
 * first (a stage's digest, a report, a status, the state at the end). A scene
 * that both refuse for the same reason is equal. blocks: threads of a block.
 * *steps counts the steps that were compared. */
const char *twin_run(const drape_def *def, int n, int64_t *steps);

#endif
