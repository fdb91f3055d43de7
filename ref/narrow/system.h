/* SPDX-License-Identifier: Apache-2.0 */
/* The polynomials of a pair with big-integer coefficients.
 * spec/narrow/narrow.md §2, §6.1 */
#ifndef REF_SYSTEM_H
#define REF_SYSTEM_H

#include "ref/narrow/point.h"

struct system {
    int count;             /* number of forms, and of box forms */
    struct poly v;         /* the cubic V */
    struct poly n[3];      /* the normal N, by axis */
    struct poly q[4][3];   /* forms, by axis */
    struct poly box[4][3]; /* box forms, by axis */
};

/* Makes the polynomials from finite positions x[t][vertex][axis]; kind 0 is
 * vertex-face, 1 edge-edge. */
void system_make(struct big_arena *m, double x[2][4][3], int kind,
                 struct system *s);

#endif
