/* SPDX-License-Identifier: Apache-2.0 */
/* A step that the library would refuse, by the reference's insides. */
#ifndef BENCH_FORCED_H
#define BENCH_FORCED_H

#include "ci/bench/accuracy.h"

/* Runs a sample's explicit method at one substep whatever its limit: stable,
 * diverged, or `missed` where a state is not finite and nothing said so. */
const char *forced_run(struct bench *b, const struct sample *s, int steps);

#endif
