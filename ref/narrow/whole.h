/* SPDX-License-Identifier: Apache-2.0 */
/* A pair's polynomials in whole numbers: spec/narrow/narrow.md §2 and §6.1. */
#ifndef REF_WHOLE_H
#define REF_WHOLE_H

#include "ref/narrow/point.h"

struct system {
    int count;             /* of forms and box forms */
    struct poly v;         /* V */
    struct poly n[3];      /* N, by axis */
    struct poly q[4][3];   /* forms, by axis */
    struct poly box[4][3]; /* box forms, by axis */
};

/* Of finite positions x[t][vertex][axis], kind 0 vertex-face, 1 edge-edge. */
void system_make(struct room *m, double x[2][4][3], int kind, struct system *s);

#endif
