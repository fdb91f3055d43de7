/* SPDX-License-Identifier: Apache-2.0 */
/* Times of impact and distances beside what else computes them. */
#ifndef BENCH_IMPACT_H
#define BENCH_IMPACT_H

#include "ci/bench/accuracy.h"

/* impacts.csv: ours, FCL's, bisection's; against exact rationals. */
void impact_times(struct bench *b);
/* distances.csv: ours and a textbook's in binary32, against long double. */
void impact_distances(struct bench *b);

#endif
