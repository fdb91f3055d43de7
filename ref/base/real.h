/* SPDX-License-Identifier: Apache-2.0 */
/* The number type of a build, binary32 or binary64, and the operations on
 * numbers, vectors and symmetric blocks. spec/README.md §1 defines each to the
 * last bit. */
#ifndef REF_REAL_H
#define REF_REAL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "ref/base/names.h"

#if REAL_BITS == 32
typedef float real;
typedef uint32_t real_bits;
#else
typedef double real;
typedef uint64_t real_bits;
#endif

/* The literal x in the build's precision, rounded to nearest. */
#define R(x) ((real)(x))

/* Largest magnitude of a coordinate or velocity that a stage accepts. */
#define REAL_BIG R(1152921504606846976.0) /* 2^60 */

typedef struct vec {
    real x, y, z;
} vec;

/* A symmetric 3 × 3 block. */
typedef struct sym {
    real xx, xy, xz, yy, yz, zz;
} sym;

/* Minimum and maximum. On a tie, or if an operand is NaN, the result is the
 * second operand, as with SSE's min and max. */
static inline real real_min(real a, real b)
{
    return a < b ? a : b;
}
static inline real real_max(real a, real b)
{
    return a > b ? a : b;
}

static inline real real_abs(real a)
{
    return a < 0 ? -a : a;
}

static inline real real_sqrt(real a)
{
    /* IEEE 754 demands a correctly rounded root: the same bits everywhere. */
    return sizeof a == sizeof(float) ? (real)sqrtf((float)a) : (real)sqrt(a);
}

/* Whether |a| ≤ REAL_BIG; false for NaN. */
static inline bool real_sane(real a)
{
    return a >= -REAL_BIG && a <= REAL_BIG;
}

/* Returns the next number above a finite a. */
static inline real real_up(real a)
{
    real_bits b;
    if (a == 0)
        b = 1; /* the smallest subnormal, from either zero */
    else {
        memcpy(&b, &a, sizeof b);
        b = a > 0 ? b + 1 : b - 1;
    }
    memcpy(&a, &b, sizeof a);
    return a;
}

/* Returns the next number below a finite a. */
static inline real real_down(real a)
{
    return -real_up(-a);
}

static inline vec vec_make(real x, real y, real z)
{
    vec r = {x, y, z};
    return r;
}

static inline vec vec_add(vec a, vec b)
{
    return vec_make(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline vec vec_sub(vec a, vec b)
{
    return vec_make(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline vec vec_scale(real s, vec a)
{
    return vec_make(s * a.x, s * a.y, s * a.z);
}

/* Returns a + s·b, two roundings a component. */
static inline vec vec_axpy(vec a, real s, vec b)
{
    return vec_make(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* (x·x + y·y) + z·z, left to right. */
static inline real vec_dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec vec_cross(vec a, vec b)
{
    return vec_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                    a.x * b.y - a.y * b.x);
}

static inline real vec_length(vec a)
{
    return real_sqrt(vec_dot(a, a));
}

static inline vec vec_min(vec a, vec b)
{
    return vec_make(real_min(a.x, b.x), real_min(a.y, b.y), real_min(a.z, b.z));
}

static inline vec vec_max(vec a, vec b)
{
    return vec_make(real_max(a.x, b.x), real_max(a.y, b.y), real_max(a.z, b.z));
}

static inline bool vec_sane(vec a)
{
    return real_sane(a.x) && real_sane(a.y) && real_sane(a.z);
}

static inline sym sym_add(sym a, sym b)
{
    sym r = {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz,
             a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
    return r;
}

/* Returns the product a b; each component is summed as (x + y) + z. */
static inline vec sym_apply(sym a, vec b)
{
    return vec_make(a.xx * b.x + a.xy * b.y + a.xz * b.z,
                    a.xy * b.x + a.yy * b.y + a.yz * b.z,
                    a.xz * b.x + a.yz * b.y + a.zz * b.z);
}

#endif
