/* SPDX-License-Identifier: Apache-2.0 */
/* Stage kinematics: computes the prescribed positions of obstacles and pins at
 * a time. spec/world/kinematics.md */
#ifndef REF_KINEMATICS_H
#define REF_KINEMATICS_H

#include "ref/base/stage.h"

/* A rigid motion at one time. It takes the point X of the definition to
 * p + R (X - pivot). */
struct pose {
    double p[3], pivot[3];
    double rotation[9]; /* R by rows */
};

struct kinematics {
    int64_t n;               /* vertices */
    const double *rest;      /* [n][3] m, as defined, or of the frame before */
    const double *next;      /* [n][3] m, of the frame after; NULL: none */
    double blend;            /* 0 … 1 from rest to next */
    const int32_t *motion;   /* [n] index of the vertex's pose; -1: none */
    const struct pose *pose; /* [poses] */
    int64_t poses;
    vec *x; /* out: [n] m */
};

/* DRAPE_OK, or DRAPE_EDATA if a position leaves |x| ≤ 2^60. */
int ref_kinematics(struct kinematics *s);

/* Returns the pose of a motion at time t, in s. Runs on the host for both
 * backends. §2 */
struct pose kinematics_pose(const drape_motion *motion, double t);

#endif
