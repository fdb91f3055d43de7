/* SPDX-License-Identifier: Apache-2.0 */
/* Compares drape's times of impact and distances with other methods. */
#ifndef BENCH_IMPACT_H
#define BENCH_IMPACT_H

#include "bench/accuracy.h"

/* Writes impacts.csv: drape_ccd, FCL and bisection against exact rationals. */
void impact_times(struct bench *b);
/* Writes distances.csv: drape's distance and a textbook's in binary32, against
 * long double. */
void impact_distances(struct bench *b);

#endif
