/* SPDX-License-Identifier: Apache-2.0 */
/* Conservative bisection of a collision query, for comparison. */
#ifndef BENCH_BISECT_H
#define BENCH_BISECT_H

#include <stdbool.h>

/* Returns whether the primitives may touch, and in *toi a lower bound of the
 * time. Boxes of time and of the primitives' parameters are halved down to
 * `width` as long as the difference of the points may be 0 in them (Snyder
 * 1992). No contact is missed, but some may be invented. */
bool bisect(int kind, const double x0[4][3], const double x1[4][3],
            double width, double *toi);

#endif
