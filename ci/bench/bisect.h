/* SPDX-License-Identifier: Apache-2.0 */
/* Conservative bisection of a collision query, for comparison. */
#ifndef BENCH_BISECT_H
#define BENCH_BISECT_H

#include <stdbool.h>

/* Whether the primitives may touch, and a lower bound of when: boxes in time
 * and the primitives' parameters are halved down to `width` as long as what
 * they reach contains 0 (Snyder 1992). Never misses, may invent. */
bool bisect(int kind, const double x0[4][3], const double x1[4][3],
            double width, double *toi);

#endif
