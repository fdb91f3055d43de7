/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of binary64 in either build, for sums and differences that would lose
 * too much in binary32. */
#ifndef REF_WIDE_H
#define REF_WIDE_H

#include "ref/base/real.h"

struct wide {
    double x, y, z;
};

static inline struct wide wide_make(double x, double y, double z)
{
    struct wide r = {x, y, z};
    return r;
}

static inline struct wide wide_of(vec a)
{
    return wide_make((double)a.x, (double)a.y, (double)a.z);
}

/* Rounds each component to the build's precision. */
static inline vec wide_round(struct wide a)
{
    return vec_make((real)a.x, (real)a.y, (real)a.z);
}

static inline struct wide wide_sub(struct wide a, struct wide b)
{
    return wide_make(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline struct wide wide_scale(double s, struct wide a)
{
    return wide_make(s * a.x, s * a.y, s * a.z);
}

/* Returns a + s·b, two roundings a component. */
static inline struct wide wide_axpy(struct wide a, double s, struct wide b)
{
    return wide_make(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* (x·x + y·y) + z·z, left to right. */
static inline double wide_dot(struct wide a, struct wide b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct wide wide_cross(struct wide a, struct wide b)
{
    return wide_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                     a.x * b.y - a.y * b.x);
}

#endif
