/* SPDX-License-Identifier: Apache-2.0 */
/* The directions and the force law of springs on the device.
 * spec/cloth/cloth.md §2 and §5 */
#ifndef GPU_CLOTH_CUH
#define GPU_CLOTH_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/cloth/cloth.h"
}

/* §2: forward direction o: (1,0) (0,1) (1,1) (-1,1), then the double of
 * each. */
static __host__ __device__ constexpr int forward_i(int o)
{
    int one = o % 4 == 0 || o % 4 == 2 ? 1 : o % 4 == 3 ? -1 : 0;
    return o < SPRINGS_SINGLE ? one : 2 * one;
}
static __host__ __device__ constexpr int forward_j(int o)
{
    int one = o % 4 == 0 ? 0 : 1;
    return o < SPRINGS_SINGLE ? one : 2 * one;
}

/* §7: the share of a single spring's constant that belongs to the cells beside
 * it; cells: about its first particle. */
static __device__ inline real spring_fraction(int o, int cells)
{
    int both = o == 0 ? 1 + 4 : 1 + 2;
    return o > 1 || (cells & both) == both ? R(1) : R(0.5);
}

/* §7: the second difference, by differences. */
static __device__ inline vec triple_at(vec before, vec middle, vec after)
{
    return add(sub(before, middle), sub(after, middle));
}

/* §5: g(q) = P(t) / s, s = √(q + shift), t = s − 25/32. */
static __device__ inline real spring_s(real q)
{
    return root(q + R(0.21723362821122166));
}

/* P by Horner's rule. */
static __device__ inline real spring_p(real t)
{
    real p = R(0.94535780075) * t - R(1.41489955139);
    p = p * t + R(1.94328409844);
    p = p * t - R(2.96088097053);
    p = p * t + R(4.67227098415);
    p = p * t - R(7.81897177916);
    return p * t + R(15.3546581234);
}

/* dP/dt, and the integral of P from 0. */
static __device__ inline real spring_dp(real t)
{
    real p = R(5.6721468045) * t - R(7.07449775695);
    p = p * t + R(7.77313639376);
    p = p * t - R(8.88264291159);
    p = p * t + R(9.3445419683);
    return p * t - R(7.81897177916);
}
static __device__ inline real spring_ip(real t)
{
    real p = R(0.13505111439285714) * t - R(0.23581659189833333);
    p = p * t + R(0.388656819688);
    p = p * t - R(0.7402202426325);
    p = p * t + R(1.5574236613833333);
    p = p * t - R(3.90948588958);
    p = p * t + R(15.3546581234);
    return p * t;
}

/* §8: what a spring longer than `limit` has more: tension, slope, energy. */
static __device__ inline real spring_more(const struct law *a, real length)
{
    real e = length - a->limit, w = min_of(e, a->over);
    return a->gain * w * (e + (e - w));
}
static __device__ inline real spring_more_slope(const struct law *a,
                                                real length)
{
    return 2 * (a->gain * min_of(length - a->limit, a->over));
}
static __device__ inline real spring_more_energy(const struct law *a,
                                                 real length)
{
    real e = length - a->limit, w = min_of(e, a->over);
    return a->gain * w * (w * w / 3 + e * (e - w));
}

/* §9: the piece that holds for a length above rest: the last that has begun. */
static __device__ inline const struct piece *
spring_piece(const struct law *a, const struct piece *t, real length)
{
    int at = a->first;
    for (int k = 1; k < a->pieces && length > t[a->first + k].from; k++)
        at = a->first + k;
    return t + at;
}

/* The same three of a spring longer than `from`. t: the cloth's pieces. */
static __device__ inline real spring_long(const struct law *a,
                                          const struct piece *t, real length)
{
    real f;
    if (a->pieces > 0) {
        const struct piece *is = spring_piece(a, t, length);
        f = is->pull + is->slope * (length - is->from);
    } else
        f = a->k * (length - a->rest);
    return length > a->limit ? f + spring_more(a, length) : f;
}
static __device__ inline real
spring_long_slope(const struct law *a, const struct piece *t, real length)
{
    real k = a->k;
    if (a->pieces > 0)
        k = spring_piece(a, t, length)->slope;
    return length > a->limit ? k + spring_more_slope(a, length) : k;
}
static __device__ inline real
spring_long_energy(const struct law *a, const struct piece *t, real length)
{
    real e;
    if (a->pieces > 0) {
        const struct piece *is = spring_piece(a, t, length);
        real d = length - is->from;
        e = is->work + d * (is->pull + R(0.5) * is->slope * d);
    } else {
        real d = length - a->rest;
        e = R(0.5) * a->k * d * d;
    }
    return length > a->limit ? e + spring_more_energy(a, length) : e;
}

/* Tension, N, of a spring of the given length. */
static __device__ inline real spring_tension(const struct law *a,
                                             const struct piece *t, real length)
{
    if (length > a->from)
        return spring_long(a, t, length);
    if (length >= a->knee) {
        real k = length >= a->rest ? a->k : a->compression;
        return k * (length - a->rest);
    }
    real s = spring_s(length / a->rest);
    return -(a->bend * (spring_p(s - R(0.78125)) / s));
}

/* Slope of the tension, N/m. */
static __device__ inline real spring_slope(const struct law *a,
                                           const struct piece *t, real length)
{
    if (length > a->from)
        return spring_long_slope(a, t, length);
    if (length >= a->knee)
        return length >= a->rest ? a->k : a->compression;
    real s = spring_s(length / a->rest), h = s - R(0.78125);
    real slope = (spring_p(h) / s - spring_dp(h)) / (2 * s * s);
    return a->bend * slope / a->rest;
}

/* Elastic energy, J, 0 at the rest length. */
static __device__ inline real spring_energy(const struct law *a,
                                            const struct piece *t, real length)
{
    real d = length - a->rest;
    if (length > a->from)
        return spring_long_energy(a, t, length);
    if (length >= a->knee) {
        real k = length >= a->rest ? a->k : a->compression;
        return R(0.5) * k * d * d;
    }
    real h = spring_s(length / a->rest) - R(0.78125);
    return a->well - a->bend * a->rest * (2 * spring_ip(h));
}

#endif
