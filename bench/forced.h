/* SPDX-License-Identifier: Apache-2.0 */
/* A step that the library would refuse, by the reference's insides. */
#ifndef BENCH_FORCED_H
#define BENCH_FORCED_H

#include "bench/accuracy.h"

/* Runs a sample's explicit method with one substep a step, whatever its limit.
 * Returns how the run ended: `stable`; `diverged`; `missed` if the state is not
 * finite and no outcome said so; or `failed`. The last two are failed checks.
 */
const char *forced_run(struct bench *b, const struct sample *s, int steps);

#endif
