/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of three numbers in binary64, as positions are in meshes. */
#ifndef APP_BASE_VEC3_H
#define APP_BASE_VEC3_H

#include <math.h>

static inline double vec3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec3_length(const double a[3])
{
    return sqrt(vec3_dot(a, a));
}

static inline void vec3_cross(const double a[3], const double b[3],
                              double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] =
            a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static inline void vec3_subtract(const double a[3], const double b[3],
                                 double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* Makes a vector one of length 1, or of 0. Returns how long it was. */
static inline double vec3_normalise(double a[3])
{
    double length = vec3_length(a);
    for (int i = 0; i < 3; i++)
        a[i] /= length > 0 ? length : 1;
    return length;
}

#endif
