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

enum { KINEMATICS_OTHERS = 3 };

struct kinematics {
    int64_t n;          /* vertices */
    const double *rest; /* [n][3] m, as defined, or of a frame */
    int others;         /* number of frames beside it */
    const double *other[KINEMATICS_OTHERS]; /* [others][n][3] m */
    double weight[KINEMATICS_OTHERS]; /* [others] parts of the ways to them */
    const int32_t *motion;   /* [n] index of the vertex's pose; -1: none */
    const struct pose *pose; /* [poses] */
    int64_t poses;
    vec *x; /* out: [n] m */
};

/* DRAPE_OK, or DRAPE_EDATA if a position leaves |x| ≤ 2^60. */
int ref_kinematics(struct kinematics *s);

/* Returns the pose of a motion at time t, in s. Runs on the host for both
 * backends, as what follows does. §2 */
struct pose kinematics_pose(const drape_motion *motion, double t);

/* When a mesh's frames are, as drape_obstacle has it. */
struct sequence {
    int count, between; /* ≥ 1; enum drape_between */
    double dt;          /* s; not used with time */
    const double *time; /* [count] s; NULL: every dt from 0 on */
};
/* Sets rest, others and weights to the places at time t, in s, of a mesh whose
 * frames are at `frame` [count][n][3] m, in memory of the backend. §4 */
void kinematics_frame(const struct sequence *frames, const double *frame,
                      double t, struct kinematics *s);

#endif
