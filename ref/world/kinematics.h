/* SPDX-License-Identifier: Apache-2.0 */
/* Stage kinematics: where obstacles and pins are told to be at a time.
 * spec/world/kinematics.md */
#ifndef REF_KINEMATICS_H
#define REF_KINEMATICS_H

#include "ref/base/stage.h"

/* A rigid motion at one time: x = p + R (x(0) - pivot). */
struct pose {
    double p[3], pivot[3];
    double rotation[9]; /* R by rows */
};

struct kinematics {
    int64_t n;               /* vertices */
    const double *rest;      /* [n][3] m, at time 0 or at the frame before */
    const double *next;      /* [n][3] m, at the frame after; NULL: no frames */
    double blend;            /* 0 … 1 from rest to next */
    const int32_t *motion;   /* [n] pose that leads, -1: none */
    const struct pose *pose; /* [poses] */
    int64_t poses;
    vec *x; /* out: [n] m */
};

/* DRAPE_OK, or DRAPE_EDATA if a position leaves |x| ≤ 2^60. */
int ref_kinematics(struct kinematics *s);

/* The pose of a motion at time t, s. On the host, once a step. §2 */
struct pose kinematics_pose(const drape_motion *motion, double t);

#endif
