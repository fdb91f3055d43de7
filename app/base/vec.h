/* SPDX-License-Identifier: Apache-2.0 */
/* Three-dimensional vectors in binary32, for the pictures. */
#ifndef APP_BASE_VEC_H
#define APP_BASE_VEC_H

#include <math.h>

typedef struct {
    float x, y, z;
} vec;

static inline vec make(float x, float y, float z)
{
    return (vec){x, y, z};
}
static inline vec from(const float p[3])
{
    return make(p[0], p[1], p[2]);
}
static inline vec add(vec a, vec b)
{
    return make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline vec sub(vec a, vec b)
{
    return make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline vec mul(vec a, vec b)
{
    return make(a.x * b.x, a.y * b.y, a.z * b.z);
}
static inline vec scale(vec a, float s)
{
    return make(a.x * s, a.y * s, a.z * s);
}
static inline float dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec mix(vec a, vec b, float t)
{
    return add(scale(a, 1 - t), scale(b, t));
}
static inline vec cross(vec a, vec b)
{
    return make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                a.x * b.y - a.y * b.x);
}
static inline vec unit(vec a)
{
    float n = sqrtf(dot(a, a));
    return n > 0 ? scale(a, 1 / n) : make(0, 1, 0);
}
static inline float clamp(float a)
{
    return a < 0 ? 0 : a > 1 ? 1 : a;
}

#endif
