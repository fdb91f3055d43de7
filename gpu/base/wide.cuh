/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of binary64 on the device, in the builds of both precisions. */
#ifndef GPU_WIDE_CUH
#define GPU_WIDE_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/base/wide.h"
}

static __device__ inline struct wide wide3(double x, double y, double z)
{
    struct wide r = {x, y, z};
    return r;
}

static __device__ inline struct wide widen(vec a)
{
    return wide3((double)a.x, (double)a.y, (double)a.z);
}

/* Rounds each component to the build's precision. */
static __device__ inline vec narrowed(struct wide a)
{
    return make((real)a.x, (real)a.y, (real)a.z);
}

static __device__ inline struct wide sub(struct wide a, struct wide b)
{
    return wide3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static __device__ inline struct wide scale(double s, struct wide a)
{
    return wide3(s * a.x, s * a.y, s * a.z);
}

/* Returns a + s·b, two roundings a component. */
static __device__ inline struct wide axpy(struct wide a, double s,
                                          struct wide b)
{
    return wide3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* (x·x + y·y) + z·z */
static __device__ inline double dot(struct wide a, struct wide b)
{
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

static __device__ inline struct wide cross(struct wide a, struct wide b)
{
    return wide3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                 a.x * b.y - a.y * b.x);
}

#endif
